// SPDX-License-Identifier: GPL-3.0-or-later
// The readers of scenes in space. The first byte chooses the file that the input is: an environment or a query of PPL,
// a configuration of OMPL.app, or one of the files of a plan of rl. The others are there.
#include <trellis/reader/readers.hpp>

#include <string>
#include <string_view>
#include <utility>

#include "fuzz.hpp"

namespace {

constexpr std::string_view tetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
constexpr std::string_view environment =
    "Boundary Box -9:9 -9:9 -9:9\nMultiBodies 2\nActive 1\nrod.obj Volumetric Rotational\nConnections 0\nPassive\n"
    "rod.obj 3 0 0 0 0 90\n";
constexpr std::string_view plan =
    "<rlplan><prm><goal><q>9</q><q>1</q><q>1</q><q>0</q><q>0</q><q>0</q><q>1</q></goal><model><kinematics "
    "href=\"box.xml\" type=\"mdl\"/><model>0</model><scene href=\"models.xml\"/></model><start><q>1</q><q>1</q><q>1</q>"
    "<q>0</q><q>0</q><q>0</q><q>1</q></start></prm></rlplan>\n";
constexpr std::string_view kinematics =
    "<rlmdl><model><world id=\"world\"/><sixDof id=\"j\"><frame><a idref=\"world\"/><b idref=\"body\"/></frame>"
    "<max>10</max><max>2</max><max>2</max><min>0</min><min>0</min><min>0</min></sixDof></model></rlmdl>\n";
constexpr std::string_view models =
    "<rlsg><scene href=\"scene.wrl\"><model name=\"robot\"/><model name=\"maze\"/></scene></rlsg>\n";
constexpr std::string_view vrml =
    "#VRML V2.0 utf8\nDEF robot Transform { children [ DEF body Transform { children [ Shape { geometry Box { size 1 "
    "0.4 0.2 } } ] } ] }\nDEF maze Inline { url \"inner.wrl\" }\n";
constexpr std::string_view inner = "#VRML V2.0 utf8\nShape { geometry Sphere { radius 0.25 } }\n";

void write(const std::filesystem::path& path, std::string_view text) { std::ofstream(path, std::ios::binary) << text; }

/// Writes the files of all scenes but one, which is the input.
std::string write_files(const std::filesystem::path& folder, char kind, std::string_view input) {
  const auto file = [&](char of, const char* name, std::string_view text) {
    write(folder / name, of == kind ? input : text);
  };
  static_cast<void>(std::filesystem::remove(folder / "scene.query"));
  write(folder / "rod.obj", tetrahedron);
  file('e', "scene.env", environment);
  if (kind == 'q') write(folder / "scene.query", input);
  file('c', "scene.cfg", "[problem]\n");
  file('p', "plan.xml", plan);
  file('k', "box.xml", kinematics);
  file('m', "models.xml", models);
  file('v', "scene.wrl", vrml);
  file('i', "inner.wrl", inner);
  if (kind == 'e' || kind == 'q') return (folder / "scene.env").string();
  return (folder / (kind == 'c' ? "scene.cfg" : "plan.xml")).string();
}

}  // namespace

// NOLINTNEXTLINE(readability-identifier-naming)
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static trellis::fuzz::InputFile place("unused");
  if (size == 0) return 0;
  const std::string_view input(reinterpret_cast<const char*>(data), size);
  const std::string path = write_files(place.folder(), input.front(), input.substr(1));
  return trellis::fuzz::examine([&] { static_cast<void>(trellis::read_scene(path, {})); });
}

std::string trellis::fuzz::mutated(const std::string& input, std::mt19937_64& random) {
  return mutated_text(input, random);
}
