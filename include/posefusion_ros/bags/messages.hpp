// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <posefusion/BlurScore.h>
#include <posefusion/CompressedFrame.h>
#include <posefusion/Keyframe.h>
#include <posefusion/Keypoint.h>
#include <posefusion/LoopConstraint.h>
#include <posefusion/ModelView.h>
#include <posefusion/MovingObject.h>
#include <posefusion/MovingObjects.h>
#include <posefusion/People.h>
#include <posefusion/Person.h>
#include <posefusion/SparseFlow.h>
#include <posefusion/TrackingStatus.h>

namespace posefusion_ros {

// The messages of the package (namespace posefusion) beside the core's values (namespace pf).
using BlurScoreMsg = posefusion::BlurScore;
using CompressedFrameMsg = posefusion::CompressedFrame;
using KeyframeMsg = posefusion::Keyframe;
using KeypointMsg = posefusion::Keypoint;
using LoopConstraintMsg = posefusion::LoopConstraint;
using ModelViewMsg = posefusion::ModelView;
using MovingObjectMsg = posefusion::MovingObject;
using MovingObjectsMsg = posefusion::MovingObjects;
using PeopleMsg = posefusion::People;
using PersonMsg = posefusion::Person;
using SparseFlowMsg = posefusion::SparseFlow;
using TrackingStatusMsg = posefusion::TrackingStatus;

}  // namespace posefusion_ros
