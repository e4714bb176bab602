// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/message_traits.h>
#include <ros/serialization.h>
#include <std_msgs/Header.h>

#include <boost/shared_ptr.hpp>
#include <cstdint>
#include <string>

#include "posefusion/loop/worker.hpp"
#include "posefusion_ros/bags/messages.hpp"

namespace posefusion_ros {

/// A question on `keyframe`. Inside a manager it passes by pointer, as it is; to others it is
/// written as a posefusion/Keyframe (roscpp: adapting C++ types), and cannot be read back.
struct LoopQuestionMessage {
  using Wire = KeyframeMsg;
  using ConstPtr = boost::shared_ptr<const LoopQuestionMessage>;
  std_msgs::Header header;
  std::uint64_t session = 0;  ///< of the asking nodelet
  std::uint64_t number = 0;
  pf::LoopQuestion question;
};

/// Its answer on `loop_constraint`, to others a posefusion/LoopConstraint.
struct LoopAnswerMessage {
  using Wire = LoopConstraintMsg;
  using ConstPtr = boost::shared_ptr<const LoopAnswerMessage>;
  std_msgs::Header header;
  std::uint64_t session = 0, number = 0;  ///< of the question
  std::uint64_t closer = 0;               ///< the answering loop closer
  std::uint8_t wanted = 0;                ///< as in the wire's message
  std::uint32_t keyframe = 0;             ///< of the question
  std::string error;                      ///< empty, or there is no answer
  pf::LoopAnswer answer;
};

/// What a question wants, as flags of posefusion/Keyframe.
std::uint8_t wantedBy(const pf::LoopQuestion& question);

KeyframeMsg toWire(const LoopQuestionMessage& message);
LoopConstraintMsg toWire(const LoopAnswerMessage& message);

/// A number unique to a nodelet among all there were in this process. Thread safe.
std::uint64_t newIdentity();

/// Throws ros::Exception: such a message came from another process.
[[noreturn]] void refuseFromWire();

}  // namespace posefusion_ros

namespace ros::message_traits {

// Once for both types.
#define POSEFUSION_TRAITS_AS_WIRE(Trait, Type)                            \
  template <>                                                             \
  struct Trait<Type> {                                                    \
    static const char* value() { return Trait<Type::Wire>::value(); }     \
    static const char* value(const Type& /*message*/) { return value(); } \
  };
#define POSEFUSION_MESSAGE_AS_WIRE(Type)    \
  template <>                               \
  struct IsMessage<Type> : TrueType {};     \
  template <>                               \
  struct HasHeader<Type> : TrueType {};     \
  POSEFUSION_TRAITS_AS_WIRE(MD5Sum, Type)   \
  POSEFUSION_TRAITS_AS_WIRE(DataType, Type) \
  POSEFUSION_TRAITS_AS_WIRE(Definition, Type)

POSEFUSION_MESSAGE_AS_WIRE(posefusion_ros::LoopQuestionMessage)
POSEFUSION_MESSAGE_AS_WIRE(posefusion_ros::LoopAnswerMessage)

#undef POSEFUSION_MESSAGE_AS_WIRE
#undef POSEFUSION_TRAITS_AS_WIRE

}  // namespace ros::message_traits

namespace ros::serialization {

template <typename Message>
struct PosefusionWireSerializer {
  template <typename Stream>
  static void write(Stream& stream, const Message& message) {
    serialize(stream, posefusion_ros::toWire(message));
  }
  template <typename Stream>
  static void read(Stream& /*stream*/, Message& /*message*/) {
    posefusion_ros::refuseFromWire();
  }
  static std::uint32_t serializedLength(const Message& message) {
    return serializationLength(posefusion_ros::toWire(message));
  }
};

template <>
struct Serializer<posefusion_ros::LoopQuestionMessage>
    : PosefusionWireSerializer<posefusion_ros::LoopQuestionMessage> {};
template <>
struct Serializer<posefusion_ros::LoopAnswerMessage>
    : PosefusionWireSerializer<posefusion_ros::LoopAnswerMessage> {};

}  // namespace ros::serialization
