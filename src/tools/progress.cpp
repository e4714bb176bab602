// SPDX-License-Identifier: BSD-3-Clause
#include "progress.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace pf {
namespace {

constexpr double kTerminalInterval_ms = 100;
constexpr double kLineInterval_ms = 5000;
constexpr std::size_t kBarWidth = 30;

std::string clockText(double seconds) {
  const auto whole = static_cast<long>(std::lround(seconds));
  char text[32];
  std::snprintf(text, sizeof(text), "%ld:%02ld", whole / 60, whole % 60);
  return text;
}

}  // namespace

Progress::Progress(std::size_t total) : total_(total), terminal_(isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  if (done_ == 0) return;
  draw(done_, true);
  if (terminal_) std::fputc('\n', stderr);
}

void Progress::update(std::size_t done) {
  done_ = done;
  elapsed_ms_ += watch_.lapMs();
  const double interval = terminal_ ? kTerminalInterval_ms : kLineInterval_ms;
  if (elapsed_ms_ - drawn_ms_ < interval) return;
  drawn_ms_ = elapsed_ms_;
  draw(done, false);
}

void Progress::say(const std::string& line) {
  std::fprintf(stderr, "%s%s\n", terminal_ ? "\r\033[K" : "", line.c_str());
}

void Progress::draw(std::size_t done, bool last) {
  const double part = total_ > 0 ? std::min(1.0, static_cast<double>(done) / total_) : 1.0;
  const double rate = elapsed_ms_ > 0 ? 1e3 * static_cast<double>(done) / elapsed_ms_ : 0.0;
  std::string remaining;
  if (!last && rate > 0 && done < total_) {
    remaining = ", " + clockText(static_cast<double>(total_ - done) / rate) + " left";
  }
  if (!terminal_) {
    std::fprintf(stderr, "%zu of %zu frames, %.1f frames per second%s\n", done, total_, rate,
                 remaining.c_str());
    return;
  }
  const auto filled = static_cast<std::size_t>(part * kBarWidth);
  const std::string bar = std::string(filled, '#') + std::string(kBarWidth - filled, '.');
  std::fprintf(stderr, "\r\033[K[%s] %zu of %zu, %.1f fps%s", bar.c_str(), done, total_, rate,
               remaining.c_str());
  std::fflush(stderr);
}

}  // namespace pf
