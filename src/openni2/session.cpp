// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_openni2/session.hpp"

#include <map>
#include <mutex>

#include "posefusion/core/error.hpp"
#include "status.hpp"

namespace pf::openni2 {

/// The started library, with the only listener for devices that go: each registration of one loses
/// 64 bytes.
class Session::Library : private openni::OpenNI::DeviceDisconnectedListener {
 public:
  Library() {
    check(openni::OpenNI::initialize(), "the OpenNI2 library cannot start");
    openni::OpenNI::addDeviceDisconnectedListener(this);
  }
  ~Library() override {
    openni::OpenNI::removeDeviceDisconnectedListener(this);
    openni::OpenNI::shutdown();
  }

  int unplugCount(const std::string& uri) {
    const std::lock_guard<std::mutex> lock(mutex_);
    return unplugged_[uri];
  }

  /// Shared by all sessions of the process, made by the first.
  static std::shared_ptr<Library> shared() {
    std::shared_ptr<Library> library = current().lock();
    if (!library) current() = library = std::make_shared<Library>();
    return library;
  }

  static std::mutex& lifeMutex() {
    static std::mutex mutex;
    return mutex;
  }

 private:
  void onDeviceDisconnected(const openni::DeviceInfo* info) override {
    const std::lock_guard<std::mutex> lock(mutex_);
    ++unplugged_[info->getUri()];
  }
  static std::weak_ptr<Library>& current() {
    static std::weak_ptr<Library> library;
    return library;
  }

  std::mutex mutex_;
  std::map<std::string, int> unplugged_;
};

std::string lastError() {
  std::string text = openni::OpenNI::getExtendedError();
  for (char& c : text) c = c == '\n' || c == '\t' ? ' ' : c;
  const auto end = text.find_last_not_of(' ');
  text = end == std::string::npos ? "" : text.substr(0, end + 1);
  return text.empty() ? "OpenNI2 gives no reason" : text;
}

void check(openni::Status status, const std::string& what) {
  if (status != openni::STATUS_OK) throw InputError(what + ": " + lastError());
}

// The library counts its users without a lock: starting and stopping must not overlap.
Session::Session() {
  const std::lock_guard<std::mutex> lock(Library::lifeMutex());
  library_ = Library::shared();
}

Session::~Session() {
  const std::lock_guard<std::mutex> lock(Library::lifeMutex());
  library_.reset();
}

int Session::unplugCount(const std::string& uri) const { return library_->unplugCount(uri); }

}  // namespace pf::openni2
