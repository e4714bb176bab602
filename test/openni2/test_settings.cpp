// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "posefusion/core/error.hpp"
#include "posefusion_openni2/settings.hpp"

namespace pf::openni2 {
namespace {

TEST(StreamMode, IsReadAsItIsWritten) {
  for (const StreamMode& mode : {StreamMode{640, 480, 30}, StreamMode{1280, 1024, 15}}) {
    EXPECT_EQ(parseMode(toText(mode)), mode);
  }
  EXPECT_EQ(toText({320, 240, 60}), "320x240@60");
}

TEST(StreamMode, RefusesAnythingElseAndNamesIt) {
  for (const char* text : {"", "640x480", "640x480@", "640x480@30 ", "640*480@30", "-640x480@30",
                           "640x0@30", "VGA", "640x480@30.5", "99999999999x1@1"}) {
    try {
      parseMode(text);
      ADD_FAILURE() << "accepted '" << text << "'";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("'" + std::string(text) + "'"), std::string::npos);
      EXPECT_NE(std::string(error.what()).find("640x480@30"), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace pf::openni2
