// SPDX-License-Identifier: GPL-3.0-or-later
#include <CGAL/IO/polygon_soup_io.h>
#include <CGAL/Simple_cartesian.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "support/catch.hpp"
#include "support/folder.hpp"
#include "unit/scene_spatial.hpp"

#include <trellis/reader/mesh_file.hpp>
#include <trellis/reader/robot_files.hpp>

using namespace trellis;
using namespace trellis::spatial_tests;
using Catch::Matchers::Contains;
using Catch::Matchers::EndsWith;

namespace {

namespace fs = std::filesystem;

std::string written(const std::string& name, const std::string& text) {
  static const test::Folder folder;
  return folder.write(name, text);
}

template <class T>
std::string bytes_of(T value, bool big = false) {
  auto bytes = std::bit_cast<std::array<char, sizeof(T)>>(value);
  if (big) std::reverse(bytes.begin(), bytes.end());
  return {bytes.begin(), bytes.end()};
}

std::string stl_of(const Soup& soup) {
  std::string text = "solid some thing\n";
  for (const Triangle& t : soup.triangles) {
    text += " facet normal 0 0 0\n  outer loop\n";
    for (const std::uint32_t v : t) {
      const Vec3& p = soup.vertices[v];
      text += fmt::format("   vertex {} {} {}\n", p.x, p.y, p.z);
    }
    text += "  endloop\n endfacet\n";
  }
  return text + "endsolid\n";
}

std::string binary_stl_of(const Soup& soup, const std::string& heading = "made by hand") {
  std::string text = heading;
  text.resize(80, ' ');
  text += bytes_of(static_cast<std::uint32_t>(soup.triangles.size()));
  for (const Triangle& t : soup.triangles) {
    text += std::string(12, '\0');
    for (const std::uint32_t v : t) {
      const Vec3& p = soup.vertices[v];
      for (const double x : {p.x, p.y, p.z}) text += bytes_of(static_cast<float>(x));
    }
    text += std::string(2, '\0');
  }
  return text;
}

std::string obj_of(const Soup& soup) {
  std::string text = "# a comment\no thing\n";
  for (const Vec3& v : soup.vertices) text += fmt::format("v {} {} {}\n", v.x, v.y, v.z);
  for (const Triangle& t : soup.triangles) text += fmt::format("f {} {}/2 {}//3\n", t[0] + 1, t[1] + 1, t[2] + 1);
  return text;
}

std::string off_of(const Soup& soup) {
  std::string text = fmt::format("OFF # heading\n{} {} 0\n\n", soup.vertices.size(), soup.triangles.size());
  for (const Vec3& v : soup.vertices) text += fmt::format("{} {} {} 255 0 0\n", v.x, v.y, v.z);
  for (const Triangle& t : soup.triangles) text += fmt::format("3  {} {} {}\n", t[0], t[1], t[2]);
  return text;
}

std::string byu_of(const Soup& soup) {
  const std::size_t faces = soup.triangles.size();
  std::string text = fmt::format(" 1 {} {} {}\n 1 {}\n", soup.vertices.size(), faces, 3 * faces, faces);
  for (const Vec3& v : soup.vertices) text += fmt::format("{} {} {}\n", v.x, v.y, v.z);
  for (const Triangle& t : soup.triangles) text += fmt::format("{} {} -{} \n", t[0] + 1, t[1] + 1, t[2] + 1);
  return text;
}

std::string ply_heading(const std::string& format, const Soup& soup) {
  return fmt::format(
      "ply\nformat {} 1.0\ncomment by hand\nelement vertex {}\nproperty uchar red\nproperty double x\nproperty double "
      "y\n"
      "property float z\nelement face {}\nproperty list uchar int vertex_indices\nproperty list uchar float extra\n"
      "element edge 1\nproperty int a\nend_header\n",
      format, soup.vertices.size(), soup.triangles.size());
}

std::string ply_of(const Soup& soup) {
  std::string text = ply_heading("ascii", soup);
  for (const Vec3& v : soup.vertices) text += fmt::format("7 {} {} {}\n", v.x, v.y, v.z);
  for (const Triangle& t : soup.triangles) text += fmt::format("3 {} {} {} 1 0.5\n", t[0], t[1], t[2]);
  return text + "1\n";
}

std::string binary_ply_of(const Soup& soup, bool big) {
  std::string text = ply_heading(big ? "binary_big_endian" : "binary_little_endian", soup);
  for (const Vec3& v : soup.vertices) {
    text += '\7' + bytes_of(v.x, big) + bytes_of(v.y, big) + bytes_of(static_cast<float>(v.z), big);
  }
  for (const Triangle& t : soup.triangles) {
    text += '\3';
    for (const std::uint32_t v : t) text += bytes_of(v, big);
    text += '\1' + bytes_of(0.5F, big);
  }
  return text + bytes_of(std::uint32_t{1}, big);
}

/// (name, text) of a soup in all formats. Its coordinates are exact as floats.
std::vector<std::pair<std::string, std::string>> all_formats(const Soup& soup) {
  return {{"a.stl", stl_of(soup)},
          {"b.STL", binary_stl_of(soup)},
          {"solid.stl", binary_stl_of(soup, "solid x")},
          {"a.obj", obj_of(soup)},
          {"a.off", off_of(soup)},
          {"a.g", byu_of(soup)},
          {"a.ply", ply_of(soup)},
          {"little.ply", binary_ply_of(soup, false)},
          {"big.ply", binary_ply_of(soup, true)}};
}

std::string fault_in(const std::string& name, const std::string& text, const std::string& unit = "m") {
  const std::string path = written(name, text);
  std::string fault = fault_of([&] { read_mesh(path, {unit}); });
  // Each names its file.
  if (!fault.empty() && unit == "m") CHECK_THAT(fault, Contains(path));
  return fault;
}

const std::string cube_head = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

/// Its coordinates are exact as floats.
Soup round_torus() {
  Soup soup = torus(2, 0.5, 16, 8);
  for (Vec3& v : soup.vertices) {
    v = {std::round(64 * v.x) / 64, std::round(64 * v.y) / 64, std::round(64 * v.z) / 64};
  }
  return soup;
}

}  // namespace

TEST_CASE("each format gives the same mesh", "[reader][mesh]") {
  const Soup soup = round_torus();
  const Mesh expected = soup.mesh();
  REQUIRE(expected.closed());
  for (const auto& [name, text] : all_formats(soup)) {
    INFO(name);
    const MeshFile file = read_mesh(written(name, text));
    CHECK(file.polygons == soup.triangles.size());
    CHECK(file.without_area == 0);
    CHECK(file.warnings.empty());
    CHECK(file.mesh->closed());
    CHECK(file.mesh->triangles().size() == soup.triangles.size());
    CHECK(file.mesh->bounds() == expected.bounds());
    CHECK(file.mesh->volume() == Approx(expected.volume()));
    if (!name.ends_with("stl") && !name.ends_with("STL")) CHECK(file.mesh->hash() == expected.hash());
  }
  CHECK(read_mesh(written("a.stl", stl_of(soup))).format == "STL, ASCII");
  CHECK(read_mesh(written("a.stl", binary_stl_of(soup, "solid a"))).format == "STL, binary");
}

TEST_CASE("CGAL reads the same polygons", "[reader][mesh]") {
  using Point = CGAL::Simple_cartesian<double>::Point_3;
  const Soup soup = round_torus();
  for (const auto& [name, text] : all_formats(soup)) {
    if (name == "a.g" || name == "b.STL") continue;
    INFO(name);
    const std::string path = written(name, text);
    std::vector<Point> points;
    std::vector<std::vector<std::size_t>> polygons;
    REQUIRE(CGAL::IO::read_polygon_soup(path, points, polygons));
    std::vector<Vec3> vertices;
    vertices.reserve(points.size());
    for (const Point& p : points) vertices.push_back({p.x(), p.y(), p.z()});
    std::vector<Triangle> triangles;
    for (const auto& polygon : polygons) {
      REQUIRE(polygon.size() == 3);
      triangles.push_back({static_cast<std::uint32_t>(polygon[0]), static_cast<std::uint32_t>(polygon[1]),
                           static_cast<std::uint32_t>(polygon[2])});
    }
    CHECK(Mesh(vertices, triangles, "by CGAL").hash() == read_mesh(path).mesh->hash());
  }
}

TEST_CASE("polygons are cut into triangles, also where they are not convex", "[reader][mesh]") {
  const auto area = [](const Mesh& mesh) {
    Vec3 sum;
    double plain = 0.0;
    for (const Triangle& t : mesh.triangles()) {
      const Vec3& a = mesh.vertices()[t[0]];
      const Vec3 normal = cross(mesh.vertices()[t[1]] - a, mesh.vertices()[t[2]] - a);
      sum = sum + 0.5 * normal;
      plain += 0.5 * norm(normal);
    }
    // Triangles that overlap, or lie outside, would have more area than their sum as vectors.
    CHECK(norm(sum) == Approx(plain));
    return plain;
  };
  const auto face = [](const std::vector<Vec3>& corners) {
    std::string text, indices = "f";
    for (std::size_t i = 0; i < corners.size(); ++i) {
      text += fmt::format("v {} {} {}\n", corners[i].x, corners[i].y, corners[i].z);
      indices += fmt::format(" {}", i + 1);
    }
    return text + indices + "\n";
  };
  // An L with collinear vertices, in each plane and turned anyhow.
  const std::vector<Vec3> ell{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}, {0, 1, 0}};
  Stream stream(1, "0", "tests");
  for (int i = 0; i < 60; ++i) {
    const Pose3 pose = i < 8 ? Pose3{} : random_pose(stream, 1);
    std::vector<Vec3> corners = ell;
    std::rotate(corners.begin(), corners.begin() + i % 8, corners.end());
    if (i % 3 == 0) std::reverse(corners.begin(), corners.end());
    for (Vec3& v : corners) v = pose(v);
    const auto mesh = read_mesh(written("ell.obj", face(corners))).mesh;
    CHECK(area(*mesh) == Approx(3));
    if (i < 8) CHECK(mesh->triangles().size() == 6);
  }
  // An arrow: the diagonal from its first vertex lies outside.
  CHECK(area(*read_mesh(written("arrow.obj", face({{0, 2, 0}, {-1, 0, 0}, {0, 1, 0}, {1, 0, 0}}))).mesh) == Approx(1));
  CHECK(area(*read_mesh(written("arrow.obj", face({{1, 0, 0}, {0, 2, 0}, {-1, 0, 0}, {0, 1, 0}}))).mesh) == Approx(1));
  std::vector<Vec3> round;
  round.reserve(500);
  for (int i = 0; i < 500; ++i) round.push_back({std::cos(2 * pi * i / 500), std::sin(2 * pi * i / 500), 5});
  CHECK(area(*read_mesh(written("disc.obj", face(round))).mesh) == Approx(pi).epsilon(1e-4));
  // Random stars.
  for (int i = 0; i < 40; ++i) {
    std::vector<Vec3> star;
    double expected = 0.0;
    for (int k = 0; k < 25; ++k) {
      const double r = stream.uniform(0.2, 2.0), angle = 2 * pi * k / 25;
      star.push_back({r * std::cos(angle), 3, r * std::sin(angle)});
    }
    for (std::size_t k = 0; k < star.size(); ++k) {
      const Vec3 &a = star[k], &b = star[(k + 1) % star.size()];
      expected += 0.5 * (a.x * b.z - a.z * b.x);
    }
    CHECK(area(*read_mesh(written("star.obj", face(star))).mesh) == Approx(expected));
  }
  CHECK_THAT(fault_in("eight.obj", face({{0, 0, 0}, {2, 3, 0}, {2, 0, 0}, {0, 2, 0}})),
             Contains("eight.obj:5: polygon 1 cannot be cut into triangles: its sides cross"));
}

TEST_CASE("OBJ: relative indices, continued lines and what has no influence", "[reader][mesh]") {
  const std::string text =
      "mtllib a.mtl\r\n" + cube_head + "vn 0 0 1\ng part\nf -4 -3 \\\n -2\nf 1/1/1 3 \\\r\n4 # last\nl 1 2\n";
  const MeshFile file = read_mesh(written("relative.obj", text));
  CHECK(file.mesh->triangles() == std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}});
  // A vertex may follow, and a first line may hold the counts.
  CHECK(read_mesh(written("later.obj", "4 1\nf 1 2 3 4\n" + cube_head)).mesh->triangles().size() == 2);
}

TEST_CASE("units, and a warning where another one is likely", "[reader][mesh]") {
  const std::string cube = written("cube.stl", stl_of(box({0, 0, 0}, {2, 4, 6})));
  CHECK(read_mesh(cube).mesh->bounds().hi == Vec3{2, 4, 6});
  CHECK(read_mesh(cube, {"cm"}).mesh->bounds().hi.x == Approx(0.02));
  CHECK(read_mesh(cube, {"inch"}).mesh->bounds().hi.x == Approx(0.0508));
  CHECK(read_mesh(cube, {"0.5"}).mesh->bounds().hi == Vec3{1, 2, 3});
  CHECK(read_mesh(cube, {"mm"}).warnings.empty());
  CHECK(read_mesh(cube, {"0.5"}).vertex_mean.x == Approx(0.5));
  const std::string part = written("part.stl", stl_of(box({0, 0, 0}, {200, 400, 600})));
  REQUIRE(read_mesh(part).warnings.size() == 1);
  CHECK_THAT(read_mesh(part).warnings[0],
             EndsWith("part.stl: it extends 200 x 400 x 600 m; if its numbers are millimetres, give unit = \"mm\""));
  CHECK(read_mesh(part, {"mm"}).warnings.empty());
  const std::string metres = written("metres.stl", stl_of(box({0, 0, 0}, {1, 2, 3})));
  REQUIRE(read_mesh(metres, {"mm"}).warnings.size() == 1);
  CHECK_THAT(read_mesh(metres, {"mm"}).warnings[0],
             EndsWith("it extends only 0.001 x 0.002 x 0.003 m; its unit was given as \"mm\", but they may be metres"));
  CHECK_THAT(fault_of([&] { read_mesh(part, {"inc"}); }), Contains("got \"inc\" (did you mean 'inch'?)"));
  for (const std::string unit : {"", "0", "-1", "nan", "inf", "m2"}) {
    CHECK_THAT(fault_of([&] { read_mesh(part, {unit}); }), Contains("unit must be"));
  }
}

TEST_CASE("triangles without area are left out, and counted", "[reader][mesh]") {
  Soup soup = box({0, 0, 0}, {1, 1, 1});
  soup.triangles.push_back({0, 1, 1});
  soup.vertices.push_back({2, 0, 0});
  soup.triangles.push_back({0, 1, 8});
  for (const auto& [name, text] : all_formats(soup)) {
    INFO(name);
    const MeshFile file = read_mesh(written(name, text));
    CHECK(file.without_area == 2);
    CHECK(file.mesh->closed());
    REQUIRE(file.warnings.size() == 1);
    CHECK_THAT(file.warnings[0], EndsWith(name + ": 2 triangles without area were left out"));
  }
  CHECK_THAT(fault_in("line.obj", cube_head + "f 1 2 2\nf 1 1 1\n"), EndsWith("none of its 2 polygons has an area"));
}

TEST_CASE("faults of mesh files name the line", "[reader][mesh]") {
  struct Case {
    std::string name;
    std::string text;
    std::string fault;
  };
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string faces = "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const std::string facet = "solid a\nfacet normal 0 0 1\nouter loop\n";
  for (const auto& [name, text, fault] : std::vector<Case>{
           {"a.obj", cube_head + "f 1 2 5\n", ":5: polygon 1 names vertex 5 (counted from 1), but the file has 4"},
           {"a.obj", cube_head + "f 0 1 2\n", ":5: polygon 1 names vertex 0; vertices are counted from 1"},
           {"a.obj", cube_head + "f 1 2 -5\n", ":5: polygon 1 names vertex -5, but there are 4 before it"},
           {"a.obj", cube_head + "f 1 2 -9223372036854775808\n", ":5: polygon 1 names vertex -9223372036854775808"},
           {"a.obj", cube_head + "f 1 2 99999999999999999999\n", ":5: polygon 1: expected the index of a vertex"},
           {"a.obj", cube_head + "f 1 2\n", ":5: polygon 1 needs 3 to 1000 vertices, got 2"},
           {"a.obj", "v 0 nan 0\n", ":1: vertex 1 must lie within 1e+09 m of 0 in x, y and z, got (0, nan, 0)"},
           {"a.obj", "v 0 0 1e999\n", ":1: vertex 1 must lie within"},
           {"a.obj", "\nv 0 0\n", ":2: vertex 1 needs three numbers, got fewer"},
           {"a.obj", "v 0 0 0x1\n", ":1: vertex 1 needs three numbers, got '0x1'"},
           {"a.obj",
            "\x7f"
            "ELF\x02\n",
            ":1: '?ELF?' is no statement of an OBJ file"},
           {"a.obj", "cstype bezier\n", ":1: 'cstype': curves and free-form surfaces are not read"},
           {"a.obj", "9e9 1\n", ":1: it declares 9000000000 vertices"},
           {"a.obj", "", ": it has no triangles"},
           {"a.off", "ON\n", ":1: expected 'OFF' (or COFF, NOFF, CNOFF, STOFF), got 'ON'"},
           {"a.off", "OFF BINARY\n", ":1: binary OFF files are not read"},
           {"a.off", "OFF\n3 1000000000 0\n", ":2: it declares 1000000000 polygons; a mesh has at most 2000000"},
           {"a.off", "OFF\n1000000000 1 0\n", ":2: it declares 1000000000 vertices"},
           {"a.off", "OFF\n3000 1 0\n0 0 0\n", ":2: it declares 3000 vertices and 1 polygons, for which its 19 bytes"},
           {"a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n", ":4: the file ends after 2 of 3 vertices"},
           {"a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", ":6: polygon 1 names vertex 4 (counted from 1)"},
           {"a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 -1 2\n", ":6: polygon 1 names vertex -1"},
           {"a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1\n",
            ":6: polygon 1 needs 3 indices of vertices, got fewer"},
           {"a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n1000000 0 1 2\n", "got fewer"},
           {"a.g", "1 3 1 3\n1 1\n0 0 0\n1 0 0\n0 1 0\n1 2 3\n", ":6: the file ends after 0 of 1 polygons"},
           {"a.g", "1 3 1 3\n1 1\n0 0 0\n1 0 0\n0 1 0\n1 2 -4\n", ":6: polygon 1 names vertex 4 (counted from 1)"},
           {"a.g", "1 3 1 3\n1 1\n0 0 0\n1 0 0\n0 1 x\n1 2 -3\n", ":5: vertex 3 needs three numbers, got 'x'"},
           {"a.g", "1 3 1 3\n1 1\n0 0 0\n1 0 0\n0 1 0\n1 2 -9223372036854775808\n",
            ":6: polygon 1 names vertex -9223372036854775808"},
           {"a.ply", "pli\n", ":1: expected 'ply', got 'pli'"},
           {"a.ply", "ply\nformat ascii 2.0\n", ":2: expected 'format ascii 1.0'"},
           {"a.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty real x\n",
            ":4: 'real' is no type of a PLY file"},
           {"a.ply", "ply\nformat ascii 1.0\nproperty float x\n", ":3: a property before the first element"},
           {"a.ply", ply, ":6: the file ends before 'end_header'"},
           {"a.ply", ply + "end_header\n0 0 0\n1 0 0\n0 1 0\n",
            ": it has no faces: it is a cloud of points, which point_cloud { \"FILE\", radius = 0.01 } reads"},
           {"a.ply", ply + faces + "0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", ":13: polygon 1 names vertex 4 (counted from 1)"},
           {"a.ply", ply + faces + "0 0 0\n1 0 0\n0 1 0\n3 0 1 0.5\n", ":13: expected an integer, got '0.5'"},
           {"a.ply", ply + faces + "0 0 0\n1 0 0\n0 1 0\n2 0 1\n", ":13: polygon 1 needs 3 to 1000 vertices, got 2"},
           {"a.ply", ply + faces + "0 0 0\n1 0 0\n0 1 0\n3 0 1\n", ":13: the file ends too early"},
           {"a.ply", ply + faces + "0 0 0\n1 inf 0\n0 1 0\n3 0 1 2\n", ":11: vertex 2 must lie within"},
           {"a.ply", ply + "element face 1000000000\n", "the file ends before 'end_header'"},
           {"a.ply", ply + "element face 1000000000\nproperty list uchar int vertex_indices\nend_header\n",
            ": it declares 1000000000 polygons"},
           {"a.ply", ply + "element dust 1000000000\nproperty float a\nend_header\n0 0 0\n1 0 0\n0 1 0\n",
            "declares 1000000000 elements 'dust', which take at least 2000000000 bytes"},
           {"a.ply", ply + "element dust 1000000000\nend_header\n0 0 0\n1 0 0\n0 1 0\n",
            "element 'dust' has no properties"},
           {"a.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\n",
            ":6: expected 'vertex', got 'endloop'"},
           {"a.stl", facet + "vertex 0 0 0\nvertex 1 0 0\nvertex 0 nan 0\n", ":6: vertex 3 must lie within"},
           {"a.stl", facet + "vertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n", ":6: the file ends before 'endloop'"},
           {"a.stl", "solid a\nfacit\n", ":2: expected 'facet' or 'endsolid', got 'facit'"},
           {"a.stl", "solid a\nendsolid\n", ": it has no triangles"},
           {"a.stl", "binary", ":1: it is no STL file"},
           {"a.stl", "", ":1: it is no STL file"}}) {
    INFO(name << ": " << text);
    CHECK_THAT(fault_in(name, text), Contains(name + fault) || (Contains(fault) && !Contains(name + ":1:")));
  }
}

TEST_CASE("STL as programs write it: other cases, a byte order mark, blank lines, bytes at the end", "[reader][mesh]") {
  const Soup soup = box({0, 0, 0}, {1, 1, 1});
  const std::string ascii = stl_of(soup);
  const auto replaced = [](std::string text, const std::string& from, const std::string& to) {
    for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
      text.replace(at, from.size(), to);
    }
    return text;
  };
  std::string upper = ascii;
  std::transform(upper.begin(), upper.end(), upper.begin(), [](unsigned char c) { return std::toupper(c); });
  const std::string mark = "\xEF\xBB\xBF";
  for (const std::string& text :
       {replaced(ascii, "solid", "Solid"), upper, replaced(ascii, "facet", "Facet"), mark + ascii, "\n" + ascii,
        "\r\n \t\r\n" + replaced(ascii, "\n", "\r\n"), mark + "\n" + ascii, ascii + "\n\n",
        "solid " + std::string(200, 'x') + ascii.substr(ascii.find('\n'))}) {
    CAPTURE(text.substr(0, 20));
    const MeshFile file = read_mesh(written("a.stl", text));
    CHECK(file.format == "STL, ASCII");
    CHECK(file.mesh->closed());
    CHECK(file.mesh->triangles().size() == 12);
    CHECK(file.warnings.empty());
  }
  for (const std::string& end : {std::string(300, '\0'), std::string("\x1A"), std::string("\x1A\0\0\0", 4)}) {
    const MeshFile file = read_mesh(written("a.stl", ascii + end));
    CHECK(file.mesh->triangles().size() == 12);
    REQUIRE(file.warnings.size() == 1);
    CHECK_THAT(file.warnings[0], EndsWith(fmt::format("a.stl: {} bytes after 'endsolid' were left out", end.size())));
  }
  // Binary, with any name in its header, and with bytes after its triangles.
  for (const std::string name : {"Solid thing", "solid\n", "\xEF\xBB\xBFsolid", "made by hand", ""}) {
    for (const std::string& end : {std::string(), std::string("\0\0", 2), std::string(100, 'x')}) {
      CAPTURE(name, end.size());
      const MeshFile file = read_mesh(written("a.stl", binary_stl_of(soup, name) + end));
      CHECK(file.format == "STL, binary");
      CHECK(file.mesh->triangles().size() == 12);
      CHECK(file.warnings.size() == (end.empty() ? 0 : 1));
      if (!end.empty()) {
        CHECK_THAT(file.warnings[0],
                   EndsWith(fmt::format("a.stl: {} bytes after its 12 triangles were left out", end.size())));
      }
    }
  }
  // Other words at the end are no padding.
  CHECK_THAT(fault_in("a.stl", ascii + "endsolid\n"), Contains("expected 'solid', got 'endsolid'"));
}

TEST_CASE("a byte order mark before a mesh changes nothing", "[reader][mesh]") {
  const Soup soup = box({0, 0, 0}, {1, 1, 1});
  for (const auto& [name, text] : all_formats(soup)) {
    if (name == "b.STL" || name == "solid.stl" || name == "little.ply" || name == "big.ply") continue;
    CAPTURE(name);
    CHECK(read_mesh(written(name, "\xEF\xBB\xBF" + text)).mesh->closed());
  }
}

TEST_CASE("limits of mesh files are checked before memory is taken", "[reader][mesh]") {
  std::string stl = binary_stl_of(box({0, 0, 0}, {1, 1, 1}));
  stl.replace(80, 4, bytes_of(std::uint32_t{1'000'000'000}));
  CHECK_THAT(fault_in("many.stl", stl),
             EndsWith("many.stl: byte 80: it declares 1000000000 triangles; a mesh has at most 2000000"));
  stl.replace(80, 4, bytes_of(std::uint32_t{13}));
  CHECK_THAT(fault_in("cut.stl", stl),
             EndsWith("it declares 13 triangles, which take 734 bytes, but the file has 684"));
  const std::string sparse = written("large.obj", "");
  fs::resize_file(sparse, (std::uintmax_t{64} << 20U) + 1U);
  CHECK_THAT(fault_of([&] { read_mesh(sparse); }), EndsWith("bytes, at most 67108864 are read"));
  fs::remove(sparse);
  std::string face = "f";
  for (int i = 0; i < 1001; ++i) face += " 1";
  CHECK_THAT(fault_in("round.obj", cube_head + face + "\n"),
             Contains(":5: polygon 1 needs 3 to 1000 vertices, got 1001"));
}

TEST_CASE("files that are no meshes are refused by name", "[reader][mesh]") {
  CHECK_THAT(fault_of([] { read_mesh("no/where.obj"); }),
             Contains("no/where.obj: the file cannot be read: No such file or directory"));
  CHECK_THAT(fault_in("a.thing", ""), EndsWith("a.thing: files of meshes end with .stl, .obj, .ply, .off, .g or .dae"));
  for (const auto& [name, what] : {std::pair{"a.step", "it is a STEP file"},
                                   {"a.wrl", "it is a VRML file"},
                                   {"a.GLTF", "it is a glTF file"},
                                   {"a.urdf", "it is a URDF"}}) {
    CHECK_THAT(fault_in(name, ""), Contains(".g or .dae; ") && Contains(what));
  }
  const std::string folder = written("x", "") + ".obj";
  fs::create_directory(folder);
  CHECK_THAT(fault_of([&] { read_mesh(folder); }), EndsWith("it is a folder"));
  CHECK(has_mesh_ending("A/B.ObJ"));
  CHECK_FALSE(has_mesh_ending("obj"));
}

TEST_CASE("a file that ends anywhere is refused or is a smaller mesh", "[reader][mesh]") {
  for (const auto& [name, text] : all_formats(box({0, 0, 0}, {1, 1, 1}))) {
    std::size_t refused = 0;
    for (std::size_t size = 0; size < text.size(); ++size) {
      if (!fault_in("cut_" + name, text.substr(0, size)).empty()) ++refused;
    }
    INFO(name);
    CHECK(10 * refused > 4 * text.size());
  }
}

namespace {

/// A tetrahedron in inches, of a node that moves it by 100 along x.
std::string collada(const std::string& triangles = "0 2 1 0 1 3 1 2 3 2 0 3") {
  return R"(<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
 <asset><created>2026-01-01T00:00:00</created><modified>2026-01-01T00:00:00</modified>
  <unit name="inch" meter="0.0254"/><up_axis>Y_UP</up_axis></asset>
 <library_geometries><geometry id="g"><mesh>
  <source id="p"><float_array id="a" count="12">0 0 0 10 0 0 0 20 0 0 0 30</float_array>
   <technique_common><accessor source="#a" count="4" stride="3"><param name="X" type="float"/>
    <param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
  <vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
  <triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/><p>)" +
         triangles + R"(</p></triangles></mesh></geometry></library_geometries>
 <library_visual_scenes><visual_scene id="s"><node id="n"><translate>100 0 0</translate>
  <instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
 <scene><instance_visual_scene url="#s"/></scene>
</COLLADA>
)";
}

/// Whether the program that converts was built; else the test warns.
bool converts_collada() {
  const std::string fault = fault_in("probe.dae", "");
  if (fault.find("libassimp-dev") == std::string::npos) return true;
  WARN("SKIPPED: trellis-mesh was not built");
  return false;
}

}  // namespace

TEST_CASE("COLLADA is read in its unit and its axes, by a process of its own", "[reader][mesh]") {
  if (!converts_collada()) return;
  const MeshFile file = read_mesh(written("a.dae", collada()));
  CHECK(file.format == "COLLADA");
  CHECK(file.polygons == 4);
  CHECK(file.mesh->closed());
  CHECK(file.mesh->bounds().lo.x == Approx(2.54));
  CHECK(file.mesh->bounds().hi.x == Approx(2.54 + 0.254));
  CHECK(file.mesh->bounds().hi.y == Approx(0.508));
  CHECK(file.mesh->bounds().hi.z == Approx(0.762));
  CHECK_THAT(fault_of([] { read_mesh(written("a.dae", collada()), {.unit = "mm"}); }), Contains("states its unit"));
}

TEST_CASE("a URDF file scales a COLLADA mesh, which has its own unit", "[reader][mesh][robot]") {
  if (!converts_collada()) return;
  static_cast<void>(written("part.dae", collada()));
  const std::string urdf = written("part.urdf", R"(<robot name="r"><link name="base"/><link name="arm"><collision>
<geometry><mesh filename="part.dae" scale="0.5 -1 2"/></geometry></collision></link>
<joint name="j" type="continuous"><parent link="base"/><child link="arm"/></joint></robot>)");
  const Solid solid = read_urdf(urdf).tree.links().at(1).solids.at(0);
  const Box3 bounds = std::get<std::shared_ptr<const Mesh>>(solid.shape)->bounds();
  CHECK(bounds.lo.x == Approx(0.5 * 2.54));
  CHECK(bounds.hi.x == Approx(0.5 * (2.54 + 0.254)));
  CHECK(bounds.lo.y == Approx(-0.508));
  CHECK(bounds.hi.z == Approx(2.0 * 0.762));
}

TEST_CASE("damaged COLLADA is an error, wherever it ends", "[reader][mesh]") {
  if (!converts_collada()) return;
  const std::string whole = collada();
  std::size_t refused = 0, tried = 0;
  for (std::size_t size = 0; size < whole.size() - 20; size += 61, ++tried) {
    if (fault_in("cut.dae", whole.substr(0, size)).find("cut.dae: ") != std::string::npos) ++refused;
  }
  CHECK(refused == tried);
  CHECK_THAT(fault_in("index.dae", collada("0 2 1 0 1 900000000 1 2 3 2 0 3")), Contains("index.dae: "));
  CHECK_THAT(fault_in("fewer.dae", collada("0 2")), Contains("fewer.dae: "));
}
