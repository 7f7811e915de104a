// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/reader/unread.hpp>

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>

namespace trellis {

namespace {

constexpr const char* convert_image = "; convert it to PNG or PGM";
constexpr const char* convert_mesh =
    "; Trellis reads meshes as .stl, .obj, .ply, .off, .g and .dae: convert it, for example with `assimp export` or "
    "Blender";
constexpr const char* shapes =
    "; Trellis reads no such worlds: write them with world { ... }, which has boxes, spheres, cylinders and mesh "
    "\"FILE\"";
constexpr const char* bodies = "; of robots with joints Trellis reads URDF files: robot.urdf(\"FILE.urdf\")";
constexpr const char* moveit =
    "; Trellis reads such scenes as YAML with 'collision_objects', and as the text that RViz exports: a name, then an "
    "object in each line with a star";
constexpr const char* points = "; an obstacle of a world: point_cloud { \"FILE\", radius = 0.01 }";

/// What begins with some bytes.
struct Signature {
  std::string_view begin;
  const char* what;
  const char* instead;
};

using namespace std::string_view_literals;

constexpr std::array<Signature, 27> signatures = {{
    {"\xFF\xD8\xFF"sv, "a JPEG image", convert_image},
    {"GIF8"sv, "a GIF image", convert_image},
    {"BM"sv, "a BMP image", convert_image},
    {"II*\0"sv, "a TIFF image", convert_image},
    {"MM\0*"sv, "a TIFF image", convert_image},
    {"P1"sv, "a PBM image", convert_image},
    {"P3"sv, "a PPM image", convert_image},
    {"P4"sv, "a PBM image", convert_image},
    {"P6"sv, "a PPM image", convert_image},
    {"P7"sv, "a PAM image", convert_image},
    {"RIFF"sv, "a RIFF file, as WebP images are", convert_image},
    {"glTF"sv, "a binary glTF file, which describes meshes for viewers", convert_mesh},
    {"Kaydara FBX"sv, "an FBX file, which describes meshes for viewers", convert_mesh},
    {"PXR-USDC"sv, "a USD file, which describes a scene for viewers", convert_mesh},
    {"#usda"sv, "a USD file, which describes a scene for viewers", convert_mesh},
    {"BLENDER"sv, "a file of Blender", convert_mesh},
    {"ISO-10303-21"sv, "a STEP file, which describes parts by their surfaces", convert_mesh},
    {"# Octomap"sv, "an octomap, which divides space into cells", "; Trellis reads no octomaps"},
    {"# .PCD"sv, "a cloud of points (PCD)", points},
    {"PK\3\4"sv, "a ZIP archive, as .npz and .3mf files are", "; unpack it"},
    {"\x1F\x8B"sv, "a file that gzip compressed", "; decompress it with gunzip"},
    {"\x93NUMPY"sv, "an array of NumPy", "; Trellis reads worlds as images (PNG, PGM)"},
    {"\x89HDF"sv, "an HDF5 file", "; Trellis reads no HDF5 files"},
    {"SQLite format 3"sv, "an SQLite database, as OMPL's benchmarks are", "; Trellis reads scenes, not results"},
    {"#ROSBAG"sv, "a bag of ROS", "; Trellis reads maps as map_saver writes them: YAML with PGM or PNG"},
    {"%PDF"sv, "a PDF document", "; Trellis reads drawings as SVG"},
    {"version https://git-lfs"sv, "a pointer of Git LFS, not the file itself", "; run git lfs pull"},
}};

/// What an XML file is by its root element.
constexpr std::array<Signature, 21> roots = {{
    {"sdf"sv, "an SDF file, a world or a model of Gazebo", shapes},
    {"gazebo"sv, "a world of Gazebo", shapes},
    {"world"sv, "a world of Gazebo or Webots", shapes},
    {"mujoco"sv, "a model of MuJoCo (MJCF)", shapes},
    {"X3D"sv, "an X3D file, which describes a scene for viewers", convert_mesh},
    {"COLLADA"sv, "a COLLADA file, a mesh", "; a file of a mesh in COLLADA ends with .dae"},
    {"rlsg"sv, "a scene of the Robotics Library", "; Trellis reads the plan that names it (<rlplan>)"},
    {"rlmdl"sv, "a model of the Robotics Library", "; Trellis reads the plan that names it (<rlplan>)"},
    {"rlkin"sv, "a kinematics of the Robotics Library", "; Trellis reads the plan that names it (<rlplan>)"},
    {"MotionPlanning"sv, "a problem of PPL in XML", "; Trellis reads the environment NAME.env, with NAME.robot"},
    {"Environment"sv, "an environment in XML, of PPL or OpenRAVE", "; Trellis reads environments of PPL as NAME.env"},
    {"environment"sv, "an environment in XML, of PPL or OpenRAVE", "; Trellis reads environments of PPL as NAME.env"},
    {"KinBody"sv, "a body of OpenRAVE", shapes},
    {"Robot"sv, "a robot of OpenRAVE", bodies},
    {"launch"sv, "a launch file of ROS", "; Trellis reads maps of ROS: YAML with PGM or PNG"},
    {"commonRoad"sv, "a scenario of CommonRoad", "; Trellis reads none of its scenarios"},
    {"OpenDRIVE"sv, "a road network (OpenDRIVE)", "; Trellis reads no road networks"},
    {"osm"sv, "a map of OpenStreetMap", "; Trellis reads drawings as SVG, and maps of ROS"},
    {"kml"sv, "a map of Google Earth (KML)", "; Trellis reads drawings as SVG, and maps of ROS"},
    {"html"sv, "a page of the web (HTML)", "; a download may have got the page of the file, not the file"},
    {"HTML"sv, "a page of the web (HTML)", "; a download may have got the page of the file, not the file"},
}};

constexpr std::array<Signature, 35> endings = {{
    {"urdf"sv, "a URDF, which describes the links and joints of a robot",
     "; robot.urdf(\"FILE.urdf\") reads it, and `trellis scene FILE.urdf` prints what is in it"},
    {"xacro"sv, "a xacro file, of which ROS makes a URDF", "; expand it first: xacro FILE > robot.urdf"},
    {"srdf"sv, "an SRDF, which names groups of a robot's joints for MoveIt",
     R"(; robot.urdf("FILE.urdf", { srdf = "FILE.srdf" }) reads it with its robot)"},
    {"sdf"sv, "an SDF file, a world or a model of Gazebo", shapes},
    {"world"sv, "a world of Gazebo or Stage", shapes},
    {"wbt"sv, "a world of Webots", shapes},
    {"mjcf"sv, "a model of MuJoCo (MJCF)", shapes},
    {"scene"sv, "a planning scene of MoveIt", moveit},
    {"gltf"sv, "a glTF file, which describes meshes for viewers", convert_mesh},
    {"glb"sv, "a binary glTF file, which describes meshes for viewers", convert_mesh},
    {"fbx"sv, "an FBX file, which describes meshes for viewers", convert_mesh},
    {"usd"sv, "a USD file, which describes a scene for viewers", convert_mesh},
    {"usda"sv, "a USD file, which describes a scene for viewers", convert_mesh},
    {"usdc"sv, "a USD file, which describes a scene for viewers", convert_mesh},
    {"usdz"sv, "a USD file, which describes a scene for viewers", convert_mesh},
    {"wrl"sv, "a VRML file, which describes a scene for viewers", convert_mesh},
    {"x3d"sv, "an X3D file, which describes a scene for viewers", convert_mesh},
    {"3ds"sv, "a 3DS mesh", convert_mesh},
    {"3mf"sv, "a 3MF mesh", convert_mesh},
    {"amf"sv, "an AMF mesh", convert_mesh},
    {"blend"sv, "a file of Blender", convert_mesh},
    {"skp"sv, "a file of SketchUp", convert_mesh},
    {"max"sv, "a file of 3ds Max", convert_mesh},
    {"ive"sv, "a mesh of OpenSceneGraph", convert_mesh},
    {"step"sv, "a STEP file, which describes parts by their surfaces", convert_mesh},
    {"stp"sv, "a STEP file, which describes parts by their surfaces", convert_mesh},
    {"iges"sv, "an IGES file, which describes parts by their surfaces", convert_mesh},
    {"igs"sv, "an IGES file, which describes parts by their surfaces", convert_mesh},
    {"dxf"sv, "a drawing (DXF)", "; Trellis reads drawings as SVG"},
    {"dwg"sv, "a drawing (DWG)", "; Trellis reads drawings as SVG"},
    {"pcd"sv, "a cloud of points (PCD)", points},
    {"las"sv, "a cloud of points (LAS)", "; convert it to PCD or PLY, which point_cloud { \"FILE\" } reads"},
    {"bt"sv, "an octomap, which divides space into cells", "; Trellis reads no octomaps"},
    {"ot"sv, "an octomap, which divides space into cells", "; Trellis reads no octomaps"},
    {"robot"sv, "a robot of PPL", "; Trellis reads the environment NAME.env beside it"},
}};

std::string sentence(const Signature& known) { return std::string("it is ") + known.what + known.instead; }

/// Returns the name of the root element of an XML text, "" where it is none.
std::string_view root_of(std::string_view text) {
  while (true) {
    text.remove_prefix(std::min(text.size(), text.find_first_not_of(" \t\r\n")));
    if (!text.starts_with('<')) return "";
    const bool comment = text.starts_with("<!--");
    if (!comment && !text.starts_with("<?") && !text.starts_with("<!")) {
      const std::string_view name = text.substr(1, text.find_first_of(" \t\r\n/>") - 1);
      const std::size_t prefix = name.find(':');  // of a namespace
      return prefix == std::string_view::npos ? name : name.substr(prefix + 1);
    }
    if (text.starts_with("<!DOCTYPE html") || text.starts_with("<!doctype html")) return "html";
    const std::string_view end = comment ? "-->" : ">";
    const std::size_t at = text.find(end);
    if (at == std::string_view::npos) return "";
    text.remove_prefix(at + end.size());
  }
}

bool has_tag(const SourceText& text, std::string_view tag) {
  return std::any_of(text.lines.begin(), text.lines.end(),
                     [&](const std::string& line) { return line.find(tag) != std::string::npos; });
}

std::string unread_root(const SourceText& text, std::string_view root) {
  if (root == "robot") {
    // Each has the same root: a URDF has links, an SRDF groups of them.
    const char* ending = has_tag(text, "xacro") ? "xacro" : has_tag(text, "<link ") ? "urdf" : "";
    if (*ending == '\0') ending = has_tag(text, "<group") || has_tag(text, "<disable_coll") ? "srdf" : "urdf";
    return unread_ending(std::string("file.") + ending);
  }
  const auto* const known =
      std::find_if(roots.begin(), roots.end(), [&](const Signature& s) { return s.begin == root; });
  if (known != roots.end()) return sentence(*known);
  return "it is an XML file with the root <" + std::string(root) +
         ">; of XML Trellis reads drawings (SVG) and plans of the Robotics Library (<rlplan>)";
}

/// YAML and JSON.
std::string unread_keys(const SourceText& text) {
  const auto has = [&](std::string_view key) { return has_key(text, key); };
  if (has("asset") && has("version") && (has("meshes") || has("scenes") || has("nodes"))) {
    return unread_ending("file.gltf");
  }
  if (has("collision_objects") || has("robot_model_name") || has("fixed_frame_transforms")) {
    return unread_ending("file.scene");
  }
  if (has("goal_constraints") || has("joint_state") || has("goal_queries") || has("start_queries")) {
    return "it is a request to MoveIt, which Trellis reads with its scene: scenes.load(\"scene0001.yaml\", { robot = "
           "... }) "
           "reads request0001.yaml beside it";
  }
  if (has("joint_limits")) return std::string("it is a file of joint limits for MoveIt") + bodies;
  if (has("mapFile") || has("agentFile")) {
    return "it is a problem of the MAPF Start-Kit; Trellis reads the map that it names (.map)";
  }
  if (has("settings") && has("benchmark")) {
    return "it is a configuration of bench-mr; Trellis reads the drawings (.svg), grids (.map.scen) and images that it "
           "names";
  }
  return "";
}

}  // namespace

std::string unread_bytes(std::string_view begin) {
  const auto* const known = std::find_if(signatures.begin(), signatures.end(),
                                         [&](const Signature& s) { return begin.starts_with(s.begin); });
  if (known == signatures.end()) return "";
  // Two letters alone may begin a text.
  constexpr std::size_t letters = 2;
  if (known->begin.size() == letters && begin.size() > letters) {
    const auto next = static_cast<unsigned char>(begin[letters]);
    if (known->begin[0] == 'P' && std::isspace(next) == 0 && next != '#') return "";
    if (known->begin == "BM" && begin.find('\0') == std::string_view::npos) return "";
  }
  return sentence(*known);
}

std::string unread_xml(const SourceText& text) {
  constexpr std::size_t most = 100;  // lines of a prolog
  std::string head;
  for (std::size_t i = 0; i < std::min(most, text.lines.size()); ++i) head += text.lines[i] + '\n';
  const std::string_view root = root_of(head);
  return root.empty() || root == "svg" || root == "rlplan" ? "" : unread_root(text, root);
}

std::string known_xml(std::string_view root) {
  const auto* const known =
      std::find_if(roots.begin(), roots.end(), [&](const Signature& s) { return s.begin == root; });
  return known == roots.end() ? "" : known->what;
}

std::string unread_text(const SourceText& text) {
  const auto first = std::find_if(text.lines.begin(), text.lines.end(),
                                  [](const std::string& line) { return !words_of(line).empty(); });
  if (first == text.lines.end()) return "it is empty";
  if (first->starts_with("#VRML_SIM")) return unread_ending("file.wbt");
  if (first->starts_with("#VRML")) return unread_ending("file.wrl");
  if (first->starts_with("discretization(cells)")) {
    return "it is a navigation grid of SBPL; of SBPL Trellis reads planar arms (linklengths)";
  }
  if (first->starts_with("return ") || first->starts_with("local ") || first->starts_with("--")) {
    return "it is a Lua script; trellis run runs it, and require loads a module";
  }
  if (std::string known = unread_keys(text); !known.empty()) return known;
  return unread_ending(text.path);
}

std::string unread_ending(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
  const auto* const known = std::find_if(endings.begin(), endings.end(), [&](const Signature& s) {
    return ending.size() == s.begin.size() + 1 && ending.substr(1) == s.begin;
  });
  return known == endings.end() ? "" : sentence(*known);
}

}  // namespace trellis
