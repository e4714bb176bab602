// SPDX-License-Identifier: BSD-3-Clause
// Runs onto a disk that is full at one moment or another: a small file system in memory, mounted in
// a namespace of its own. Skipped where that is not allowed.
#include <fstream>

#include "posefusion/io/trajectory_file.hpp"
#include "tools_scene.hpp"

namespace pf {
namespace {

namespace fs = std::filesystem;

class FullDiskTest : public ToolsTest {
 protected:
  static constexpr int kNotAllowed = 77;

  /// Runs a script of the shell in which $disk is a file system of so many kilobytes; what it
  /// prints is in `said`. Returns its exit code.
  int onDisk(int kilobytes, const std::string& script) {
    fs::create_directories(own / "disk");
    const std::string whole = "mount -t tmpfs -o size=" + std::to_string(kilobytes) + "k none '" +
                              (own / "disk") + "' 2>/dev/null || exit 77\ndisk='" + (own / "disk") +
                              "' bin='" POSEFUSION_TOOL_DIR "' input='" + sequence() + "' own='" +
                              own.str() + "'\nexport PATH=$bin:$PATH\n" + script;
    const std::string file = own.write("script.sh", whole);
    // As an ordinary user; as root where there are no namespaces of users; as root in a chroot.
    const std::string command =
        "{ for how in -rm -m '-m --propagation unchanged'; do unshare $how true && exec unshare "
        "$how sh '" +
        file + "'; done; exit 77; } > '" + (own / "said.txt") + "' 2>&1";
    const int status = std::system(command.c_str());
    said = readFile(own / "said.txt");
    return WEXITSTATUS(status);
  }

  static std::size_t count(const std::string& text, const std::string& part) {
    std::size_t times = 0;
    for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++times;
    return times;
  }
};

// Each map that is there loads, or is reported as not written yet.
constexpr char kCheckMaps[] = R"sh(
find $disk -name '*.pfdb' | while read map; do
  posefusion_map check "$map" > $own/check.txt 2>&1 && echo "loads: $map" && continue
  grep -q 'holds no map yet' $own/check.txt && echo "empty: $map" && continue
  echo "BROKEN: $(cat $own/check.txt)"
done
)sh";

TEST_F(FullDiskTest, ARunSavesWhatThereIsRoomFor) {
  int failed = 0, whole = 0;
  for (const int kilobytes : {300, 700, 1500, 2500, 4000, 6000, 9000, 60000}) {
    const int code = onDisk(kilobytes, std::string(R"sh(
posefusion_run $input --detector none --output $disk/out
code=$?
cp $disk/out/2*/trajectory.txt $own/trajectory.txt 2>/dev/null
)sh") + kCheckMaps + "test -e $disk/out/latest && echo latest\nexit $code\n");
    if (code == kNotAllowed) GTEST_SKIP() << "no file system can be mounted here";
    EXPECT_EQ(count(said, "BROKEN"), 0U) << kilobytes << " kB: " << said;
    EXPECT_LE(count(said, "the run goes on and tries again"), 1U) << said;
    EXPECT_EQ(count(said, "latest\n"), code == 0 ? 1U : 0U) << said;
    if (code == 0) {
      ++whole;
      EXPECT_EQ(count(said, "loads: "), 1U) << said;
    } else {
      ++failed;
      EXPECT_NE(said.find("cannot be"), std::string::npos) << kilobytes << " kB: " << said;
    }
    if (kilobytes >= 700) {
      EXPECT_EQ(loadTrajectory(own / "trajectory.txt").size(), 12U) << kilobytes << " kB: " << said;
    }
    std::error_code ignored;
    fs::remove(own / "trajectory.txt", ignored);
  }
  EXPECT_GT(failed, 1);
  EXPECT_GT(whole, 0);
}

TEST_F(FullDiskTest, AMapThatIsGoneOnInStaysTheOldOneOrBecomesTheNewOne) {
  ASSERT_EQ(run({sequence(), "--detector", "none", "--output", own / "first"}), 0) << said;
  const auto size = fs::file_size(own / "first/latest/map.pfdb") / 1024;
  for (const int more : {100, 400, 1000, 2000, 4000, 40000}) {
    const int code = onDisk(static_cast<int>(size) + more, std::string(R"sh(
cp $own/first/latest/map.pfdb $disk/map.pfdb
posefusion_run $input --detector none --output $own/second --map $disk/map.pfdb --continue
code=$?
)sh") + kCheckMaps + "exit $code\n");
    if (code == kNotAllowed) GTEST_SKIP() << "no file system can be mounted here";
    EXPECT_EQ(count(said, "loads: "), 1U) << more << " kB: " << said;
    EXPECT_EQ(count(said, "BROKEN"), 0U) << more << " kB: " << said;
  }
}

}  // namespace
}  // namespace pf
