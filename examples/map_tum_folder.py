#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Maps a TUM folder: map_tum_folder.py FOLDER [OUTPUT_FOLDER]"""
import sys

import posefusion

recording = posefusion.open_folder(sys.argv[1])
slam = posefusion.Slam({"frame": {"max_depth_m": 5}}, mode="pfh", recording=recording)
frames = 0
for frame in recording:
    result = slam.process(frame.color, frame.depth, frame.stamp, frame.camera)
    frames += 1
    if result.T_world_camera is None:
        print(frame.stamp, result.status, result.reason)
slam.finish()
surfels = slam.save(sys.argv[2] if len(sys.argv) > 2 else ".")
print(f"{frames} frames, {len(slam.trajectory())} poses, {surfels} surfels")
truth = recording.truth()
if len(truth):
    print(f"ATE {posefusion.evaluate.ate(truth, slam.trajectory()).translation_m.rmse:.4f} m")
