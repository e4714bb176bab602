// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/node_control.hpp"

#include <ros/init.h>
#include <ros/master.h>
#include <ros/names.h>
#include <ros/network.h>
#include <ros/this_node.h>
#include <ros/xmlrpc_manager.h>

#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <thread>

namespace posefusion_ros {
namespace {

using XmlRpc::XmlRpcValue;

/// Calls a node's own interface; `host`: where it is. False where there is no such node, or it does
/// not answer.
bool callNode(const std::string& name, const char* method, const std::string& argument,
              XmlRpcValue& result, std::string& host) {
  XmlRpcValue request, response, uri;
  request[0] = ros::this_node::getName();
  request[1] = name;
  if (!ros::master::execute("lookupNode", request, response, uri, false)) return false;
  std::uint32_t port = 0;
  if (!ros::network::splitURI(static_cast<std::string>(uri), host, port)) return false;
  const auto manager = ros::XMLRPCManager::instance();
  XmlRpc::XmlRpcClient* client = manager->getXMLRPCClient(host, static_cast<int>(port), "/");
  XmlRpcValue arguments;
  arguments[0] = ros::this_node::getName();
  if (!argument.empty()) arguments[1] = argument;
  const bool done = client->execute(method, arguments, result);
  manager->releaseXMLRPCClient(client);
  return done;
}

/// On this machine as Ctrl-C does, which is no warning in its log; as `rosnode kill` elsewhere.
/// False where there is no such node.
bool askToEnd(const std::string& name) {
  XmlRpcValue result;
  std::string host;
  if (!callNode(name, "getPid", "", result, host)) return false;
  const bool is_here = host == ros::network::getHost() || host == "localhost";
  if (is_here && result.getType() == XmlRpcValue::TypeArray && result.size() == 3 &&
      result[2].getType() == XmlRpcValue::TypeInt && static_cast<int>(result[2]) > 1) {
    return kill(static_cast<int>(result[2]), SIGINT) == 0;
  }
  return callNode(name, "shutdown", "no longer needed", result, host);
}

}  // namespace

std::vector<std::string> parentCommand() {
  std::ifstream file("/proc/" + std::to_string(getppid()) + "/cmdline");
  std::vector<std::string> words;
  for (std::string word; std::getline(file, word, '\0');) words.push_back(word);
  return words;
}

void endRoslaunch() {
  for (const std::string& word : parentCommand()) {
    if (std::filesystem::path(word).filename() != "roslaunch") continue;
    kill(getppid(), SIGINT);
    return;
  }
}

bool isNodeUp(const std::string& name) {
  XmlRpcValue result;
  std::string host;
  return callNode(name, "getPid", "", result, host);
}

void endNodes(const std::vector<std::string>& names, double patience_s) {
  for (const std::string& relative : names) {
    if (relative.empty()) continue;
    const std::string name = ros::names::resolve(relative);
    if (!askToEnd(name)) continue;
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(patience_s);
    while (std::chrono::steady_clock::now() < end && isNodeUp(name)) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  }
}

void outwait(const std::string& name, double patience_s) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(patience_s);
  const auto look = [] { std::this_thread::sleep_for(std::chrono::milliseconds(200)); };
  while (ros::ok() && std::chrono::steady_clock::now() < end && !isNodeUp(name)) look();
  while (ros::ok() && isNodeUp(name)) look();
}

}  // namespace posefusion_ros
