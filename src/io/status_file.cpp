// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/io/status_file.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

#include "number_text.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion/core/se3.hpp"
#include "posefusion/core/stamps.hpp"
#include "posefusion/io/files.hpp"

namespace pf {
namespace {

constexpr const char* kFirstNames =
    "stamp,has_pose,provisional,state,outcome,reason,tx,ty,tz,qx,qy,qz,qw,s_x,s_y,s_z,s_rx,s_ry,s_"
    "rz";
constexpr std::size_t kColumns = 6 + 7 + 6 + 21;

std::string header() {
  std::string names = kFirstNames;
  for (int i = 0; i < 6; ++i) {
    for (int j = i; j < 6; ++j) names += ",c_" + std::to_string(i) + std::to_string(j);
  }
  return names;
}

std::string quotedCell(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"') out += '"';
    out += c == '\n' ? ' ' : c;
  }
  return out + '"';
}

/// The cells of a line; a comma between quotes does not part them, two quotes mean one.
std::vector<std::string> cellsOf(const std::string& line) {
  std::vector<std::string> cells(1);
  bool inside = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"') {
      if (inside && i + 1 < line.size() && line[i + 1] == '"') {
        cells.back() += line[i++];
      } else {
        inside = !inside;
      }
    } else if (line[i] == ',' && !inside) {
      cells.emplace_back();
    } else {
      cells.back() += line[i];
    }
  }
  return cells;
}

StatusRow parseRow(const std::string& line) {
  const std::vector<std::string> cells = cellsOf(line);
  if (cells.size() != kColumns) {
    throw InputError(std::to_string(cells.size()) + " columns, expected " +
                     std::to_string(kColumns));
  }
  StatusRow row;
  row.stamp_ns = parseStamp(cells[0]);
  row.has_pose = cells[1] == "1";
  row.is_provisional = cells[2] == "1";
  row.state = cells[3];
  row.outcome = cells[4];
  row.reason = cells[5];
  const auto number = [&](std::size_t column) { return parseNumber(cells[column]); };
  row.T_map_camera.translation() = Eigen::Vector3d(number(6), number(7), number(8));
  const Eigen::Quaterniond q(number(12), number(9), number(10), number(11));
  const auto rotation = rotationOf(q);
  if (!rotation) throw InputError("the quaternion is not of unit length");
  row.T_map_camera.linear() = *rotation;
  std::size_t column = kColumns - 21;
  for (int i = 0; i < 6; ++i) {
    for (int j = i; j < 6; ++j) row.covariance(i, j) = row.covariance(j, i) = number(column++);
  }
  return row;
}

void writeRow(std::ostream& out, const StatusRow& row) {
  out << formatStamp(row.stamp_ns) << ',' << (row.has_pose ? 1 : 0) << ','
      << (row.is_provisional ? 1 : 0) << ',' << row.state << ',' << row.outcome << ','
      << quotedCell(row.reason);
  const Eigen::Vector3d t = row.T_map_camera.translation();
  const Eigen::Quaterniond q(row.T_map_camera.linear());
  for (const double value : {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()}) out << ',' << value;
  for (int i = 0; i < 6; ++i) out << ',' << std::sqrt(std::max(0.0, row.covariance(i, i)));
  for (int i = 0; i < 6; ++i) {
    for (int j = i; j < 6; ++j) out << ',' << row.covariance(i, j);
  }
  out << '\n';
}

}  // namespace

void saveStatus(const std::string& path, const std::vector<StatusRow>& rows) {
  AtomicFile file(path);
  file.stream() << header() << '\n' << std::setprecision(12);
  for (const StatusRow& row : rows) writeRow(file.stream(), row);
  file.commit();
}

std::vector<StatusRow> loadStatus(const std::string& path) {
  std::istringstream file(readFile(path));
  std::string line;
  if (!std::getline(file, line) || line != header()) {
    throw InputError(path + ": is no table of posefusion_run --save-status");
  }
  std::vector<StatusRow> rows;
  for (int number = 2; std::getline(file, line); ++number) {
    try {
      rows.push_back(parseRow(line));
    } catch (const InputError& error) {
      throw InputError(path + ":" + std::to_string(number) + ": " + error.what());
    }
  }
  return rows;
}

}  // namespace pf
