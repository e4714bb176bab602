// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace posefusion_ros {

/// Topics, relative to the namespace of the chain; remap the input in the launch file.
namespace topics {

// Input of the chain.
constexpr char kColor[] = "rgb/image_color";
constexpr char kDepth[] = "depth_registered/image";
constexpr char kCameraInfo[] = "rgb/camera_info";
constexpr char kDepthCameraInfo[] = "depth_registered/camera_info";
// From machine to machine: of the packer, below its own namespace, and as the unpacker looks for
// it.
constexpr char kCompressedFrame[] = "compressed_frame";
constexpr char kCompressedFrameOfRobot[] = "/robot/compressed_frame";
// Gate.
constexpr char kSharpColor[] = "sharp/image_color";
constexpr char kSharpDepth[] = "sharp/depth";
constexpr char kSharpCameraInfo[] = "sharp/camera_info";
constexpr char kBlurScore[] = "blur_score";
// Detector.
constexpr char kPeople[] = "people";
// Segmenter.
constexpr char kMask[] = "mask";
constexpr char kStaticDepth[] = "static_depth";
constexpr char kFlow[] = "flow";
constexpr char kPeopleUsed[] = "people_used";
constexpr char kMovingObjects[] = "moving_objects";
constexpr char kMovingObjectMarkers[] = "moving_object_markers";
constexpr char kSkeletons[] = "skeletons";
constexpr char kPeopleImage[] = "people_image";
// Fusion.
constexpr char kModelView[] = "model_view";
constexpr char kStatus[] = "status";
constexpr char kStateText[] = "state_text";
constexpr char kOdometry[] = "odometry";
constexpr char kPose[] = "pose";
constexpr char kPoseWithCovariance[] = "pose_with_covariance";
constexpr char kInitialPose[] = "initialpose";
constexpr char kProvisionalPose[] = "provisional_pose";
constexpr char kPath[] = "path";
constexpr char kSurfels[] = "surfels";
constexpr char kMesh[] = "mesh";
constexpr char kGrid[] = "grid";
// Fusion asks the loop closer, and its answer.
constexpr char kKeyframe[] = "keyframe";
constexpr char kLoopConstraint[] = "loop_constraint";
// Frames that a stage gives up, on their way to fusion, which reports them on `status`.
constexpr char kRejected[] = "rejected";

}  // namespace topics

namespace frames {

constexpr char kMap[] = "map";
constexpr char kOptical[] = "camera_rgb_optical_frame";

}  // namespace frames

/// Names in bags that we write: those of openni2_launch with registered depth.
namespace bag_topics {

constexpr char kColor[] = "/camera/rgb/image_color";
constexpr char kDepth[] = "/camera/depth_registered/image";
constexpr char kCameraInfo[] = "/camera/rgb/camera_info";
constexpr char kPeople[] = "/people";
constexpr char kTruth[] = "/truth";

}  // namespace bag_topics

}  // namespace posefusion_ros
