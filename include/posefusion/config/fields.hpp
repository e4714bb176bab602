// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace pf {

/// Each stage keeps its settings in one struct and lists them once, in a function
///
///     template <typename Visitor> void visitFields(BlurConfig& c, Visitor& visitor) {
///       visitor.number("threshold", c.threshold, 0.0, 1e6,
///                      "variance of the Laplacian; 0 = adaptive");
///     }
///
/// Everything that reads, writes, checks or documents settings is a FieldVisitor over these lists.
class FieldVisitor {
 public:
  virtual ~FieldVisitor() = default;

  /// A group of fields follows, until leave(): a stage.
  virtual void enter(const std::string& group) = 0;
  virtual void leave() = 0;

  /// The rest of the group is read at the start alone: it cannot change while the chain runs.
  virtual void atStart() {}

  virtual void flag(const char* name, bool& value, const char* help) = 0;
  virtual void number(const char* name, double& value, double min, double max,
                      const char* help) = 0;
  virtual void integer(const char* name, int& value, int min, int max, const char* help) = 0;
  virtual void text(const char* name, std::string& value, const char* help) = 0;
  /// One of a few words.
  virtual void choice(const char* name, std::string& value, const std::vector<std::string>& words,
                      const char* help) = 0;
};

}  // namespace pf
