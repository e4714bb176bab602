// SPDX-License-Identifier: BSD-3-Clause
#include <dlfcn.h>

// OpenNI2 loses memory each time that it is started and stopped (9 kB with these drivers). With its
// drivers kept in memory, the leak checker can separate their leaks from ours.
namespace {
[[maybe_unused]] void* const g_virtual =
    dlopen(POSEFUSION_VIRTUAL_DRIVER, RTLD_NOW | RTLD_NODELETE);
[[maybe_unused]] void* const g_file = dlopen(POSEFUSION_FILE_DRIVER, RTLD_NOW | RTLD_NODELETE);
}  // namespace

extern "C" const char* __lsan_default_suppressions() {
  return "leak:libOpenNI2.so\nleak:libOniFile.so\n";
}
