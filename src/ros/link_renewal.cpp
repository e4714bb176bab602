// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/link_renewal.hpp"

#include <XmlRpcClient.h>
#include <netdb.h>
#include <poll.h>
#include <ros/master.h>
#include <ros/network.h>
#include <ros/this_node.h>
#include <ros/xmlrpc_manager.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <utility>

namespace posefusion_ros {
namespace {

constexpr auto kLookPeriod = std::chrono::milliseconds(50);
constexpr int kReachTimeout_ms = 200;
constexpr std::chrono::duration<double> kLookPause{0.1};  // while the other machine is away
constexpr std::chrono::duration<double> kFirstWait{2.0}, kLongestWait{10.0};

/// A TCP connection comes about within the time; it is closed at once.
bool connects(const addrinfo& address) {
  const int handle =
      socket(address.ai_family, address.ai_socktype | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (handle < 0) return false;
  bool connected = connect(handle, address.ai_addr, address.ai_addrlen) == 0;
  if (!connected && errno == EINPROGRESS) {
    pollfd ready{handle, POLLOUT, 0};
    int error = 0;
    socklen_t size = sizeof error;
    connected = poll(&ready, 1, kReachTimeout_ms) == 1 &&
                getsockopt(handle, SOL_SOCKET, SO_ERROR, &error, &size) == 0 && error == 0;
  }
  close(handle);
  return connected;
}

bool answers(const std::string& uri) {
  std::string host;
  std::uint32_t port = 0;
  if (!ros::network::splitURI(uri, host, port)) return false;
  addrinfo wanted{};
  wanted.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (getaddrinfo(host.c_str(), std::to_string(port).c_str(), &wanted, &found) != 0) return false;
  const bool reached = found != nullptr && connects(*found);
  freeaddrinfo(found);
  return reached;
}

/// publisherUpdate of the slave API (wiki.ros.org/ROS/Slave_API).
void updatePublishers(XmlRpc::XmlRpcClient& node, const std::string& topic,
                      const std::vector<std::string>& uris) {
  XmlRpc::XmlRpcValue arguments, list, answer;
  list.setSize(0);
  for (std::size_t i = 0; i < uris.size(); ++i) list[static_cast<int>(i)] = uris[i];
  arguments[0] = ros::this_node::getName();
  arguments[1] = topic;
  arguments[2] = list;
  node.execute("publisherUpdate", arguments, answer);
}

}  // namespace

void RenewalClock::heard(Time now) {
  heard_ = now;
  has_heard_ = true;
  pause_ = pause_.zero();
}

bool RenewalClock::isToLook(Time now) const {
  return isSilent(now) && now - looked_ >= (pause_ == pause_.zero() ? kLookPause : silent_);
}

bool RenewalClock::looked(Time now, bool reachable) {
  looked_ = now;
  if (!reachable) {
    pause_ = pause_.zero();
    return false;
  }
  if (pause_ > pause_.zero() && now - renewed_ < pause_) return false;
  pause_ = pause_ == pause_.zero() ? kFirstWait : std::min(2 * pause_, kLongestWait);
  renewed_ = now;
  return true;
}

LinkRenewal::LinkRenewal(std::string topic, double silent_s, std::function<void()> tell)
    : topic_(std::move(topic)),
      tell_(std::move(tell)),
      clock_(silent_s),
      thread_([this] { run(); }) {}

LinkRenewal::~LinkRenewal() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void LinkRenewal::heard(const std::string& publisher) {
  if (publisher == ros::this_node::getName()) return;  // there is no link
  const std::lock_guard<std::mutex> lock(mutex_);
  clock_.heard(std::chrono::steady_clock::now());
  publisher_ = publisher;
}

void LinkRenewal::run() {
  bool was_silent = false;
  std::unique_lock<std::mutex> lock(mutex_);
  while (!changed_.wait_for(lock, kLookPeriod, [this] { return stopping_; })) {
    const std::string publisher = publisher_;
    const auto began = std::chrono::steady_clock::now();
    const bool silent = clock_.isSilent(began), look = clock_.isToLook(began);
    lock.unlock();
    // Messages come: the master is asked now, not when the link is cut. After a silence the
    // publisher may be another process.
    if (was_silent && !silent) uris_.clear();
    was_silent = silent;
    if (!silent && !publisher.empty() && uris_.count(publisher) == 0) learn(publisher);
    const bool reachable = look && isReachable();
    lock.lock();
    const auto now = std::chrono::steady_clock::now();
    // What was heard meanwhile counts.
    if (!look || uris_.empty() || stopping_ || !clock_.isSilent(now)) continue;
    if (!clock_.looked(now, reachable)) continue;
    lock.unlock();
    renew();
    tell_();
    lock.lock();
  }
}

void LinkRenewal::learn(const std::string& publisher) {
  XmlRpc::XmlRpcValue arguments, answer, uri;
  arguments[0] = ros::this_node::getName();
  arguments[1] = publisher;
  if (!ros::master::execute("lookupNode", arguments, answer, uri, false)) return;
  if (uri.getType() == XmlRpc::XmlRpcValue::TypeString) uris_[publisher] = std::string(uri);
}

bool LinkRenewal::isReachable() const {
  return std::any_of(uris_.begin(), uris_.end(),
                     [](const auto& entry) { return answers(entry.second); });
}

void LinkRenewal::renew() const {
  std::string host;
  std::uint32_t port = 0;
  if (!ros::network::splitURI(ros::XMLRPCManager::instance()->getServerURI(), host, port)) return;
  XmlRpc::XmlRpcClient own(host.c_str(), static_cast<int>(port), "/");
  std::vector<std::string> uris;
  for (const auto& entry : uris_) uris.push_back(entry.second);
  updatePublishers(own, topic_, {});
  updatePublishers(own, topic_, uris);
}

}  // namespace posefusion_ros
