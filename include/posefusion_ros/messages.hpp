// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// The generated headers put posefusion::Person and its like where the core has types of these names.
// While they are read, the plain names get the ending "Msg"; always include them through this file.
#define Keypoint KeypointMsg
#define Person PersonMsg
#define People PeopleMsg
#define BlurScore BlurScoreMsg
#define TrackingStatus TrackingStatusMsg
#define ModelView ModelViewMsg

#include <posefusion/BlurScore.h>
#include <posefusion/Keypoint.h>
#include <posefusion/ModelView.h>
#include <posefusion/People.h>
#include <posefusion/Person.h>
#include <posefusion/TrackingStatus.h>

#undef Keypoint
#undef Person
#undef People
#undef BlurScore
#undef TrackingStatus
#undef ModelView

namespace posefusion_ros {

using posefusion::BlurScoreMsg;
using posefusion::KeypointMsg;
using posefusion::ModelViewMsg;
using posefusion::PeopleMsg;
using posefusion::PersonMsg;
using posefusion::TrackingStatusMsg;

}  // namespace posefusion_ros
