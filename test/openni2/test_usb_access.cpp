// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "posefusion_openni2/usb_access.hpp"

namespace pf::openni2 {
namespace {

namespace fs = std::filesystem;

/// Acts as a user without rights for a while, also where the tests run as root.
class WithoutRights {
 public:
  WithoutRights() : was_root_(geteuid() == 0) {
    if (was_root_) {
      // Both: older C libraries ask for the rights of the real one.
      EXPECT_EQ(setresuid(65534, 65534, 0), 0);
    }
  }
  ~WithoutRights() {
    if (was_root_) {
      EXPECT_EQ(setresuid(0, 0, 0), 0);
    }
  }

 private:
  const bool was_root_;
};

class UsbAccess : public testing::Test {
 protected:
  void SetUp() override {
    char name[] = "/tmp/posefusion_usb_XXXXXX";
    root_ = mkdtemp(name);
    fs::permissions(root_, fs::perms(0755));
    fs::create_directories(root_ / "nodes/001");
  }
  void TearDown() override { fs::remove_all(root_); }

  /// A device in the folders; `mode` are the rights of its node.
  void add(const std::string& name, const std::string& vendor, int number, int mode) {
    const fs::path device = root_ / "sysfs" / name;
    fs::create_directories(device);
    std::ofstream(device / "idVendor") << vendor << "\n";
    std::ofstream(device / "idProduct") << "0601\n";
    std::ofstream(device / "busnum") << "1\n";
    std::ofstream(device / "devnum") << number << "\n";
    const fs::path node = root_ / "nodes/001" / ("00" + std::to_string(number));
    std::ofstream(node) << "x";
    fs::permissions(node, fs::perms(mode));
  }
  std::string ask() {
    const WithoutRights user;
    return missingUsbPermission((root_ / "sysfs").string(), (root_ / "nodes").string());
  }

  fs::path root_;
};

TEST_F(UsbAccess, NamesTheCameraItsNodeAndTheRule) {
  add("1-1", "046d", 2, 0444);
  add("1-2", "1d27", 4, 0444);
  const std::string text = ask();
  EXPECT_NE(text.find("1d27:0601"), std::string::npos) << text;
  EXPECT_NE(text.find("nodes/001/004"), std::string::npos) << text;
  EXPECT_NE(text.find("ATTR{idProduct}==\"0601\", MODE:=\"0666\""), std::string::npos) << text;
  EXPECT_NE(text.find("60-libopenni2-0.rules"), std::string::npos) << text;
}

TEST_F(UsbAccess, IsSilentAboutCamerasThatMayBeOpened) {
  add("1-2", "1d27", 4, 0666);
  EXPECT_EQ(ask(), "");
}

TEST_F(UsbAccess, IsSilentAboutOtherDevicesAndMissingFolders) {
  EXPECT_EQ(ask(), "");
  add("1-1", "046d", 2, 0444);
  EXPECT_EQ(ask(), "");
}

}  // namespace
}  // namespace pf::openni2
