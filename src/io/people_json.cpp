// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/io/people_json.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "posefusion/core/error.hpp"
#include "posefusion/core/stamps.hpp"
#include "posefusion/io/files.hpp"

namespace pf {
namespace {

using nlohmann::json;

Keypoint parseJoint(const json& entry) {
  if (!entry.is_array() || entry.size() != 3) throw InputError("a joint is not [u, v, p]");
  Keypoint joint{entry[0].get<float>(), entry[1].get<float>(), entry[2].get<float>()};
  if (!(joint.p >= 0.0F && joint.p <= 1.0F)) {
    throw InputError("p of a joint is " + entry[2].dump() + ", expected 0 to 1");
  }
  return joint;
}

Person parsePerson(const json& entry) {
  const json& joints = entry.at("joints");
  if (joints.size() != kJointCount) {
    throw InputError("a person has " + std::to_string(joints.size()) + " joints, expected 18");
  }
  Person person;
  person.score = entry.value("score", 1.0F);
  person.id = entry.value("id", 0);
  std::transform(joints.begin(), joints.end(), person.joints.begin(), parseJoint);
  return person;
}

People parseFrame(const json& entry) {
  People people;
  people.detected = true;
  people.stamp_ns = parseStamp(entry.at("stamp").get<std::string>());
  for (const json& person : entry.at("people")) people.people.push_back(parsePerson(person));
  return people;
}

void checkJointNames(const json& root) {
  if (!root.contains("joints")) return;
  const json& names = root["joints"];
  const bool same = names.size() == kJointNames.size() &&
                    std::equal(kJointNames.begin(), kJointNames.end(), names.begin(),
                               [](auto name, const json& found) { return found == name; });
  if (!same) throw InputError("joints are not those of COCO-18 in OpenPose's order");
}

/// Keys in the order given, and single-precision numbers in the shortest text that reads back.
using OutputJson = nlohmann::basic_json<nlohmann::ordered_map, std::vector, std::string, bool,
                                        std::int64_t, std::uint64_t, float>;

OutputJson toJson(const Person& person) {
  OutputJson joints = OutputJson::array();
  for (const Keypoint& joint : person.joints) joints.push_back({joint.u, joint.v, joint.p});
  OutputJson out{{"score", person.score}, {"joints", std::move(joints)}};
  if (person.id > 0) out["id"] = person.id;
  return out;
}

OutputJson toJson(const People& frame) {
  OutputJson people = OutputJson::array();
  for (const Person& person : frame.people) people.push_back(toJson(person));
  return {{"stamp", formatStamp(frame.stamp_ns)}, {"people", std::move(people)}};
}

}  // namespace

RecordedPeople loadPeople(const std::string& path) {
  RecordedPeople recorded;
  std::size_t index = 0;
  try {
    const json root = json::parse(readFile(path));
    checkJointNames(root);
    for (const json& entry : root.at("frames")) {
      const People people = parseFrame(entry);
      recorded[people.stamp_ns] = people;
      ++index;
    }
  } catch (const json::parse_error& error) {
    throw InputError(path + ": is no JSON: " + error.what());
  } catch (const json::exception& error) {
    throw InputError(path + ": frame " + std::to_string(index) + ": " + error.what());
  } catch (const InputError& error) {
    if (std::string(error.what()).rfind(path, 0) == 0) throw;
    throw InputError(path + ": frame " + std::to_string(index) + ": " + error.what());
  }
  return recorded;
}

void savePeople(const std::string& path, const std::vector<People>& frames) {
  AtomicFile file(path);
  json names = json::array();
  for (const auto name : kJointNames) names.push_back(std::string(name));
  // A line for each frame: large files stay readable and diffable.
  file.stream() << "{\"joints\": " << names.dump() << ",\n \"frames\": [";
  const char* separator = "\n";
  for (const People& frame : frames) {
    if (!frame.detected) continue;
    file.stream() << separator << "  " << toJson(frame).dump();
    separator = ",\n";
  }
  file.stream() << "\n ]}\n";
  file.commit();
}

}  // namespace pf
