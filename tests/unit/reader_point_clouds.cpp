// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>
#include <bit>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <trellis/reader/point_cloud_file.hpp>

#include "support/catch.hpp"
#include "support/folder.hpp"

using namespace trellis;
using Catch::Matchers::Contains;

namespace {

std::string written(const std::string& name, const std::string& text) {
  static const test::Folder folder;
  return folder.write(name, text);
}

template <class T>
std::string bytes_of(T value) {
  const auto bytes = std::bit_cast<std::array<char, sizeof(T)>>(value);
  return {bytes.begin(), bytes.end()};
}

const std::vector<Vec3> three = {{0.5, -1, 2}, {0, 0.25, 0}, {3, 4, -5}};

std::string pcd(const std::string& data, const std::string& fields = "x y z rgb", int points = 3) {
  return "# .PCD v0.7\nVERSION 0.7\nFIELDS " + fields +
         "\nSIZE 4 4 4 4\nTYPE F F F U\nCOUNT 1 1 1 1\nWIDTH 3\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " +
         std::to_string(points) + "\nDATA " + data + "\n";
}

std::string rows() {
  std::string bytes;
  for (const Vec3& p : three) {
    for (const double x : {p.x, p.y, p.z}) bytes += bytes_of(static_cast<float>(x));
    bytes += bytes_of(std::uint32_t{7});
  }
  return bytes;
}

/// Bytes as LZF has them, without any that repeat.
std::string as_literals(const std::string& bytes) {
  std::string out;
  for (std::size_t at = 0; at < bytes.size(); at += 32) {
    const std::string part = bytes.substr(at, 32);
    out += static_cast<char>(part.size() - 1);
    out += part;
  }
  return out;
}

std::string compressed(const std::string& lzf, std::size_t size) {
  return pcd("binary_compressed") + bytes_of(static_cast<std::uint32_t>(lzf.size())) +
         bytes_of(static_cast<std::uint32_t>(size)) + lzf;
}

}  // namespace

TEST_CASE("points are read from PLY, PCD and text", "[reader]") {
  const std::string ply =
      "ply\nformat ascii 1.0\nelement camera 1\nproperty float f\nelement vertex 3\nproperty float x\n"
      "property float y\nproperty float z\nproperty uchar red\nelement face 1\n"
      "property list uchar int vertex_indices\nend_header\n";
  std::string fields;  // of a compressed file: all x, all y, all z, all colours
  for (const auto member : {&Vec3::x, &Vec3::y, &Vec3::z}) {
    for (const Vec3& p : three) fields += bytes_of(static_cast<float>(p.*member));
  }
  for (int i = 0; i < 3; ++i) fields += bytes_of(std::uint32_t{7});
  const std::vector<std::array<std::string, 3>> files = {
      {"a.ply", ply + "1\n0.5 -1 2 9\n0 0.25 0 9\n3 4 -5 9\n3 0 1 2\n", "PLY, ASCII"},
      {"b.pcd", pcd("ascii") + "0.5 -1 2 7\n\n0 0.25 0 7\n3 4 -5 7\n", "PCD, ASCII"},
      {"c.pcd", pcd("binary") + rows(), "PCD, binary"},
      {"d.pcd", compressed(as_literals(fields), fields.size()), "PCD, compressed"},
      {"e.xyz", "# scan\n0.5 -1 2 0.1 0.2\n0 0.25 0\n\n3 4 -5\n", "points as text"},
      {"f.csv", "x,y,z,i\n0.5,-1,2,9\n0, 0.25, 0, 9\n3;4;-5\n", "points as text"},
      {"g.PTS", "3\n0.5 -1 2\n0 0.25 0\n3 4 -5\n", "points as text"}};
  for (const auto& [name, text, format] : files) {
    INFO(name);
    const PointCloudFile read = read_point_cloud(written(name, text));
    CHECK(read.points == three);
    CHECK(read.format == format);
    CHECK(read.warnings.size() == (name == "e.xyz" || name == "f.csv" ? 1 : 0));
  }
  const PointCloudFile small = read_point_cloud(written("mm.xyz", "500 -1000 2000\n"), {.unit = "mm"});
  CHECK(small.points == std::vector<Vec3>{{0.5, -1, 2}});
  CHECK_THAT(read_point_cloud(written("far.xyz", "0 0 0\n900 0 0\n")).warnings.at(0), Contains("unit = \"mm\""));
}

TEST_CASE("a header of a text names the columns of its points", "[reader]") {
  const std::vector<Vec3> points = {{1, 2, 3}, {4, 5, 6}};
  for (const std::string text : {"id,x,y,z\n7,1,2,3\n8,4,5,6\n", "z;intensity;Y;\"x\"\n3;;2;1\n6;9;5;4\n",
                                 "# scan\nx y z time\n1 2 3 0\n4 5 6 0\n", "//X Y Z R\n1 2 3 255\n4 5 6 255\n"}) {
    CAPTURE(text);
    const PointCloudFile read = read_point_cloud(written("named.csv", text));
    CHECK(read.points == points);
    REQUIRE(read.warnings.size() == 1);
    CHECK_THAT(read.warnings[0], Contains("is not read"));
  }
  const PointCloudFile read = read_point_cloud(written("bare.csv", "1,2,3,9\n4,5,6,9\n"));
  CHECK(read.points == points);
  REQUIRE(read.warnings.size() == 1);
  CHECK_THAT(read.warnings[0], Contains("bare.csv:1: the line has 4 columns and none has a name"));
  CHECK_THROWS_WITH(
      read_point_cloud(written("places.csv", "id,lat,lon\n7,1,2\n")),
      Contains("places.csv:1: the first line names the columns 'id', 'lat', 'lon': a cloud has columns x, y "
               "and z"));
  CHECK_THROWS_WITH(read_point_cloud(written("twice.csv", "x,y,z,x\n7,1,2,1\n")),
                    Contains("two columns are called 'x'"));
  CHECK_THROWS_WITH(read_point_cloud(written("blank.csv", "id,x,y,z\n7,1,,3\n")),
                    Contains("blank.csv:2: a point needs three numbers"));
}

TEST_CASE("compressed points repeat what was before", "[reader]") {
  // Four equal points: a literal of four bytes, then what repeats them, short and long.
  const std::string zeros = std::string(1, '\3') + std::string(4, '\0');
  const std::string shorter = std::string("\xA0\x03", 2);                          // seven bytes from four before
  const std::string longer = std::string("\xE0", 1) + std::string("\x1C\x03", 2);  // 37 bytes from four before
  const PointCloudFile read = read_point_cloud(written("zeros.pcd", compressed(zeros + shorter + longer, 48)));
  CHECK(read.points == std::vector<Vec3>(3));
  CHECK_THROWS_WITH(read_point_cloud(written("before.pcd", compressed(zeros + std::string("\xA0\x04", 2), 11))),
                    Contains("points take 48 bytes"));
  CHECK_THROWS_WITH(read_point_cloud(written("back.pcd", compressed(zeros + std::string("\xA0\x7F", 2), 48))),
                    Contains("damaged"));
}

TEST_CASE("points that are no numbers are an error with its line, or are left out", "[reader]") {
  const std::string text = pcd("ascii") + "0 0 0 7\nnan nan nan 7\n1 0 0 7\n";
  CHECK_THROWS_WITH(read_point_cloud(written("nan.pcd", text)),
                    Contains("nan.pcd:13: point 2 is (nan, nan, nan); `skip_nan"));
  const PointCloudFile read = read_point_cloud(written("nan.pcd", text), {.skip_nan = true});
  CHECK(read.points == std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}});
  CHECK(read.skipped == 1);
  CHECK_THROWS_WITH(read_point_cloud(written("none.xyz", "nan 0 0\n"), {.skip_nan = true}),
                    Contains("none of its 1 points has numbers"));
}

TEST_CASE("damaged files of points are errors with their reason", "[reader]") {
  const std::vector<std::array<std::string, 3>> files = {
      {"empty.xyz", "", "it has no points"},
      {"words.xyz", "0 0 0\n1 2 cat\n", "words.xyz:2: a point needs three numbers, got 'cat'"},
      {"two.xyz", "0 0 0\n1 2\n", "two.xyz:2: a point needs three numbers, got fewer"},
      {"far.xyz", "0 0 1e12\n", "point 1 must lie within"},
      {"scan.las", "", "files of points end with .ply, .pcd"},
      {"short.pcd", pcd("binary") + rows().substr(1), "its 3 points take 48 bytes, and 47 follow"},
      {"more.pcd", pcd("binary", "x y z rgb", 1000000000) + rows(), "it declares 1000000000 points"},
      {"few.pcd", pcd("ascii") + "0 0 0 7\n", "it declares 3 points and has 1"},
      {"narrow.pcd", pcd("ascii") + "0 0\n", "narrow.pcd:12: the line has fewer numbers than FIELDS"},
      {"fields.pcd", pcd("ascii", "x y w rgb") + "0 0 0 7\n", "the points need a field 'z'"},
      {"data.pcd", pcd("zip"), "data.pcd:11: DATA is ascii"},
      {"head.pcd", "VERSION 0.7\n", "the file ends before DATA"},
      {"size.pcd", "FIELDS x y z\nSIZE 4 4 3\n", "size.pcd:2: the size of a field"},
      {"less.pcd", "FIELDS x y z\nSIZE 4 4\n", "less.pcd:2: SIZE has fewer entries"},
      {"odd.pcd", "FIELDS x y z\nSIZES 4 4 4\n", "odd.pcd:2: expected a line of a PCD heading"},
      {"none.ply", "ply\nformat ascii 1.0\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n",
       "it has no vertices"}};
  for (const auto& [name, text, reason] : files) {
    INFO(name);
    CHECK_THROWS_WITH(read_point_cloud(written(name, text)), Contains(reason));
  }
}
