// SPDX-License-Identifier: BSD-3-Clause
// The test replaces fsync() and rename(), to see the order of AtomicFile's calls.
#include "posefusion/io/files.hpp"

#include <dlfcn.h>
#include <gtest/gtest.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <vector>

#include "temporary_folder.hpp"

namespace {

std::vector<std::string> asked;  // of the disk, in order
bool disk_fails = false;

}  // namespace

extern "C" int fsync(int fd) {
  std::error_code ignored;
  const auto link = "/proc/self/fd/" + std::to_string(fd);
  asked.push_back("fsync " + std::filesystem::read_symlink(link, ignored).string());
  if (disk_fails) errno = EIO;
  return disk_fails ? -1 : 0;
}

extern "C" int rename(const char* from, const char* to) noexcept {
  using Rename = int (*)(const char*, const char*);
  asked.push_back("rename to " + std::string(to));
  return reinterpret_cast<Rename>(dlsym(RTLD_NEXT, "rename"))(from, to);
}

namespace pf {
namespace {

class AtomicFileTest : public testing::Test {
 protected:
  void SetUp() override {
    asked.clear();
    disk_fails = false;
  }
  void write(const std::string& text) const {
    AtomicFile file(path());
    file.stream() << text;
    file.commit();
  }
  std::string path() const { return folder / "file.txt"; }

  TemporaryFolder folder;
};

TEST_F(AtomicFileTest, TheBytesAreOnTheDiskBeforeTheNameAndTheNameIsBeforeCommitReturns) {
  write("new");
  ASSERT_EQ(asked.size(), 3U);
  EXPECT_EQ(asked[0].rfind("fsync " + path() + ".part", 0), 0U) << asked[0];
  EXPECT_EQ(asked[1], "rename to " + path());
  EXPECT_EQ(asked[2], "fsync " + folder.str());
}

TEST_F(AtomicFileTest, TheManyFilesOfARecordingDoNotWaitForTheDisk) {
  AtomicFile file(path());
  file.commit(AtomicFile::Until::system);
  EXPECT_EQ(asked, std::vector<std::string>{"rename to " + path()});
}

TEST_F(AtomicFileTest, ADiskThatFailsLeavesTheOldFile) {
  write("old");
  disk_fails = true;
  EXPECT_NE(errorOf([&] { write("new"); }).find(path() + ": cannot be written"), std::string::npos);
  EXPECT_EQ(readFile(path()), "old");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.str()), {}), 1);
}

TEST_F(AtomicFileTest, WithoutCommitNothingIsLeft) {
  { AtomicFile(path()).stream() << "half"; }
  EXPECT_TRUE(std::filesystem::is_empty(folder.str()));
}

}  // namespace
}  // namespace pf
