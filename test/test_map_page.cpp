// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "posefusion/core/error.hpp"
#include "posefusion/core/static_odds.hpp"
#include "posefusion/io/files.hpp"
#include "posefusion/io/map_page.hpp"
#include "temporary_folder.hpp"

namespace pf {
namespace {

/// A level square of `side` x `side` surfels, 1 cm apart.
SurfelArrays squareOf(std::size_t side) {
  SurfelArrays s;
  s.resize(side * side);
  for (std::size_t i = 0; i < s.size(); ++i) {
    s.x[i] = 0.01F * static_cast<float>(i % side);
    s.y[i] = 0.01F * static_cast<float>(i / side);
    s.nz[i] = 1;
    s.r[i] = static_cast<float>(i % 256);
    s.radius[i] = 0.01F;
    s.weight[i] = 5;
    s.odds[i] = static_odds::kMost;
  }
  return s;
}

/// RFC 4648. Fails the test where the text is no such thing.
std::vector<std::uint8_t> decoded(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  EXPECT_EQ(text.size() % 4, 0U);
  std::vector<std::uint8_t> out;
  for (std::size_t i = 0; i + 4 <= text.size(); i += 4) {
    std::uint32_t word = 0;
    std::size_t padding = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const bool is_padding = text[i + k] == '=' && i + 4 == text.size() && k >= 2;
      const std::size_t digit = is_padding ? 0 : digits.find(text[i + k]);
      EXPECT_NE(digit, std::string::npos) << text[i + k] << " at " << i + k;
      EXPECT_TRUE(padding == 0 || is_padding);
      padding += is_padding ? 1 : 0;
      word = word << 6 | static_cast<std::uint32_t>(digit);
    }
    for (std::size_t k = 0; k + padding < 3; ++k) {
      out.push_back(static_cast<std::uint8_t>(word >> (16 - 8 * k)));
    }
  }
  return out;
}

/// What stands between two texts, the first time.
std::string between(const std::string& page, const std::string& before, const std::string& after) {
  const std::size_t begin = page.find(before);
  if (begin == std::string::npos) return {};
  const std::size_t from = begin + before.size();
  return page.substr(from, page.find(after, from) - from);
}

std::string pageOf(const PageGeometry& geometry, const std::string& title = "room") {
  std::ostringstream out;
  writeMapPage(out, geometry, title);
  return out.str();
}

nlohmann::json factsOf(const std::string& page) {
  return nlohmann::json::parse(
      between(page, "<script id=\"facts\" type=\"application/json\">", "</script>"));
}

std::vector<std::uint8_t> chunkOf(const std::string& page, std::size_t i) {
  return decoded(between(
      page, "<script id=\"chunk" + std::to_string(i) + "\" type=\"application/octet-stream\">",
      "</script>"));
}

void expectNothingFromOutside(const std::string& page) {
  EXPECT_EQ(page.find("http:"), std::string::npos);
  EXPECT_EQ(page.find("https:"), std::string::npos);
  EXPECT_EQ(page.find("{{"), std::string::npos);  // all of the template is filled in
  for (const char* word : {"@import", "url(", "fetch(", "XMLHttpRequest", "WebSocket", " src="}) {
    EXPECT_EQ(page.find(word), std::string::npos) << word;
  }
  EXPECT_NE(page.find("default-src 'none'"), std::string::npos);
  const std::regex link("(href|action)=\"(?!data:)");
  EXPECT_FALSE(std::regex_search(page.substr(0, 5000), link));
}

TEST(MapPage, AMeshCanBeReadFromThePageAsItWas) {
  const PageGeometry geometry = pageMesh(squareOf(100), {}, 10'000'000);
  const std::string page = pageOf(geometry);
  expectNothingFromOutside(page);
  const auto facts = factsOf(page);
  EXPECT_EQ(facts["shows"], "triangles");
  EXPECT_EQ(facts["triangles"], geometry.triangles);
  ASSERT_EQ(facts["chunks"].size(), geometry.chunks.size());
  for (std::size_t i = 0; i < geometry.chunks.size(); ++i) {
    const PageChunk& chunk = geometry.chunks[i];
    const auto bytes = chunkOf(page, i);
    ASSERT_EQ(bytes.size(), chunk.bytes());
    const std::size_t vertices = chunk.vertices.size() * sizeof(PageVertex);
    EXPECT_EQ(std::memcmp(bytes.data(), chunk.vertices.data(), vertices), 0);
    EXPECT_EQ(std::memcmp(&bytes[vertices], chunk.indices.data(), bytes.size() - vertices), 0);
    EXPECT_EQ(facts["chunks"][i]["vertices"], chunk.vertices.size());
    EXPECT_NEAR(facts["chunks"][i]["side"][0].get<float>(), chunk.side.x(), 1e-5);
  }
}

TEST(MapPage, SurfelsAreManyChunksInOnePage) {
  const PageGeometry geometry = pageSurfels(squareOf(300), 10'000'000);
  ASSERT_GE(geometry.chunks.size(), 2U);
  const std::string page = pageOf(geometry);
  expectNothingFromOutside(page);
  const auto facts = factsOf(page);
  EXPECT_EQ(facts["shows"], "surfels");
  EXPECT_EQ(facts["vertices"], 90000);
  std::size_t bytes = 0;
  for (std::size_t i = 0; i < geometry.chunks.size(); ++i) bytes += chunkOf(page, i).size();
  EXPECT_EQ(bytes, 90000 * sizeof(PageVertex));
  // The box is that of nearly all.
  EXPECT_NEAR(facts["box"]["high"][0].get<float>(), 2.99, 0.03);
}

TEST(MapPage, ATitleIsTextWhateverItHolds) {
  const std::string page =
      pageOf(pageSurfels(squareOf(3), 10'000), "</title><script>alert(1)</script>\"{{chunks}}&");
  EXPECT_EQ(page.find("<script>alert"), std::string::npos);
  EXPECT_NE(page.find("<title>&lt;/title&gt;&lt;script&gt;alert(1)&lt;/script&gt;&quot;"),
            std::string::npos);
  EXPECT_EQ(chunkOf(page, 0).size(), 9 * sizeof(PageVertex));
}

TEST(MapPage, AFileIsNoLargerThanItMayBe) {
  const TemporaryFolder folder;
  MapPageConfig config;
  config.size_limit_mb = 0.3;
  for (const PageKind kind : {PageKind::mesh, PageKind::surfels}) {
    config.kind = kind;
    saveMapPage(folder / "a.html", squareOf(400), "room", config);
    const auto size = std::filesystem::file_size(folder / "a.html");
    EXPECT_LE(size, 300'000U);
    EXPECT_GT(size, 150'000U);
  }
}

TEST(MapPage, WhatCannotBeIsRefusedAndNothingIsLeft) {
  const TemporaryFolder folder;
  const auto refusal = [&](const std::string& name, std::size_t side, const MapPageConfig& config) {
    return errorOf([&] { saveMapPage(folder / name, squareOf(side), "room", config); });
  };
  EXPECT_NE(refusal("a.txt", 9, {}).find("a.txt: ends in '.txt', expected .html"),
            std::string::npos);
  EXPECT_NE(refusal("none/a.html", 9, {}).find("none/a.html: cannot be written"),
            std::string::npos);
  EXPECT_NE(refusal("a.html", 0, {}).find("0 stable surfels are too few"), std::string::npos);
  EXPECT_NE(refusal("a.html", 1, {}).find("1 stable surfels are too few"), std::string::npos);
  MapPageConfig config;
  config.kind = PageKind::surfels;
  EXPECT_NE(refusal("a.html", 0, config).find("none of 0 stable surfels"), std::string::npos);
  config.size_limit_mb = 0;
  EXPECT_NE(refusal("a.html", 9, config).find("size limit: is 0.000000, expected 0.1 to 500 MB"),
            std::string::npos);
  EXPECT_TRUE(std::filesystem::is_empty(folder.str()));
}

}  // namespace
}  // namespace pf
