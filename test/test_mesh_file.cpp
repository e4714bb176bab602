// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>
#include <sstream>

#include "posefusion/core/error.hpp"
#include "posefusion/io/files.hpp"
#include "posefusion/io/mesh_file.hpp"
#include "posefusion/io/ply.hpp"
#include "temporary_folder.hpp"

namespace pf {
namespace {

/// A square of two triangles, a metre above the origin.
TriangleMesh square() {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1.5F}};
  mesh.normals.assign(4, {0, 0, 1});
  mesh.colors = {{0, 0, 0}, {255, 255, 255}, {128, 10, 20}, {1, 2, 3}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

std::string refusal(const std::string& path) {
  try {
    loadMesh(path);
  } catch (const InputError& error) {
    return error.what();
  }
  return "read";
}

class MeshFile : public testing::Test {
 protected:
  const TemporaryFolder folder;
  const TriangleMesh mesh = square();
};

TEST_F(MeshFile, PlyIsReadAsItWasWritten) {
  saveMesh(folder / "a.ply", mesh);
  const TriangleMesh read = loadMesh(folder / "a.ply");
  EXPECT_EQ(read.positions, mesh.positions);
  EXPECT_EQ(read.normals, mesh.normals);
  EXPECT_EQ(read.colors, mesh.colors);
  EXPECT_EQ(read.triangles, mesh.triangles);
  EXPECT_EQ(loadPoints(folder / "a.ply").size(), 4U);  // readers of points read the vertices
}

TEST_F(MeshFile, ObjHasALineForEachThing) {
  saveMesh(folder / "a.obj", mesh);
  std::istringstream lines(readFile(folder / "a.obj"));
  std::map<std::string, int> counts;
  std::string line, last;
  for (; std::getline(lines, line); last = line) ++counts[line.substr(0, line.find(' '))];
  EXPECT_EQ(counts["v"], 4);
  EXPECT_EQ(counts["vn"], 4);
  EXPECT_EQ(counts["f"], 2);
  EXPECT_EQ(last, "f 1//1 3//3 4//4");
}

TEST_F(MeshFile, GlbFollowsTheSpecification) {
  saveMesh(folder / "a.glb", mesh);
  const std::string file = readFile(folder / "a.glb");
  const auto word = [&](std::size_t at) {
    std::uint32_t value = 0;
    std::memcpy(&value, &file[at], sizeof value);
    return value;
  };
  EXPECT_EQ(file.substr(0, 4), "glTF");
  EXPECT_EQ(word(4), 2U);
  EXPECT_EQ(word(8), file.size());
  const std::size_t json_bytes = word(12);
  EXPECT_EQ(json_bytes % 4, 0U);
  EXPECT_EQ(file.substr(16, 4), "JSON");
  const auto json = nlohmann::json::parse(file.substr(20, json_bytes));
  const std::size_t begin = 20 + json_bytes + 8;
  EXPECT_EQ(word(begin - 8), file.size() - begin);
  EXPECT_EQ(json["buffers"][0]["byteLength"], file.size() - begin);
  EXPECT_EQ(json["accessors"][0]["max"], (std::vector<float>{1, 1, 1.5F}));
  const std::size_t indices = json["bufferViews"][3]["byteOffset"];
  EXPECT_EQ(word(begin + indices + 20), 3U);  // the last corner of all
  // White is as bright as can be, middle grey less than half as bright.
  const std::size_t colors = json["bufferViews"][2]["byteOffset"];
  EXPECT_EQ(word(begin + colors + 8), 0xffffffffU);
  EXPECT_NEAR(word(begin + colors + 16) & 0xffffU, 14146, 30);
}

TEST_F(MeshFile, WhatCannotBeIsRefused) {
  EXPECT_THROW(saveMesh(folder / "a.stl", mesh), InputError);
  EXPECT_THROW(saveMesh(folder / "none/a.ply", mesh), InputError);
  EXPECT_NE(refusal(folder.write("a.ply", "nonsense")).find("a.ply: has no PLY"),
            std::string::npos);
  saveMesh(folder / "b.ply", mesh);
  const std::string whole = readFile(folder / "b.ply");
  EXPECT_NE(refusal(folder.write("c.ply", whole.substr(0, whole.size() - 1))).find("not whole"),
            std::string::npos);
  std::string wrong = whole;
  wrong[wrong.size() - 1] = 1;
  EXPECT_NE(refusal(folder.write("d.ply", wrong)).find("a face that cannot be"), std::string::npos);
}

}  // namespace
}  // namespace pf
