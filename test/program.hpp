// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <string>
#include <vector>

#include "posefusion/io/files.hpp"

namespace pf {

/// A program that runs, with stdout and stderr in one file.
class Program {
 public:
  Program(const std::string& name, std::vector<std::string> arguments, const std::string& log)
      : log_(log) {
    arguments.insert(arguments.begin(), std::string(POSEFUSION_TOOL_DIR) + "/" + name);
    std::vector<char*> argv;
    for (auto& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    pid_ = fork();
    if (pid_ != 0) return;
    const int file = open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    dup2(file, STDOUT_FILENO);
    dup2(file, STDERR_FILENO);
    execv(argv[0], argv.data());
    _exit(127);
  }

  void send(int signal) const { kill(pid_, signal); }

  int exitCode() const {
    int status = 0;
    waitpid(pid_, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }
  std::string said() const { return readFile(log_); }

 private:
  std::string log_;
  pid_t pid_;
};

}  // namespace pf
