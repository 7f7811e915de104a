// SPDX-License-Identifier: GPL-3.0-or-later
// trellis-mesh ENDING [y-up]: reads a file in a format of assimp from standard input and prints its polygons as OFF, in
// metres where the file states its unit. Coordinates stay in the file's axes, as other programs for robots have them;
// with y-up assimp turns the file's up axis to y, and equal vertices are joined. A process of its own because assimp
// may write beyond its memory on damaged files: the reader of meshes (reader/mesh_dae.cpp) starts it and trusts nothing
// that it prints.
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <sys/resource.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <string>
#include <vector>

namespace {

constexpr rlim_t most_memory = rlim_t{2} << 30U;  // bytes
constexpr rlim_t most_time = 20;                  // s of CPU time
constexpr std::size_t most_input = std::size_t{64} << 20U;

void limit(int what, rlim_t most) {
  const rlimit both{most, most};
  if (::setrlimit(what, &both) != 0) std::_Exit(2);
}

int fail(const std::string& why) {
  std::printf("error %s\n", why.c_str());
  return 1;
}

/// The polygons of a scene, with vertices where its nodes move them.
struct Soup {
  std::vector<aiVector3D> vertices;
  std::vector<std::vector<std::size_t>> faces;

  void add(const aiScene& scene, const aiNode& node, const aiMatrix4x4& above) {
    const aiMatrix4x4 pose = above * node.mTransformation;
    for (unsigned m = 0; m < node.mNumMeshes; ++m) {
      const aiMesh& mesh = *scene.mMeshes[node.mMeshes[m]];
      const std::size_t first = vertices.size();
      for (unsigned v = 0; v < mesh.mNumVertices; ++v) vertices.push_back(pose * mesh.mVertices[v]);
      for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
        const aiFace& face = mesh.mFaces[f];
        if (face.mNumIndices < 3) continue;  // points and lines
        std::vector<std::size_t>& corners = faces.emplace_back();
        for (unsigned i = 0; i < face.mNumIndices; ++i) corners.push_back(first + face.mIndices[i]);
        if (pose.Determinant() < 0.0F) std::reverse(corners.begin(), corners.end());  // a mirrored node
      }
    }
    for (unsigned i = 0; i < node.mNumChildren; ++i) add(scene, *node.mChildren[i], pose);
  }
};

int convert(const char* ending, bool y_up) {
  std::vector<char> text;
  std::vector<char> block(std::size_t{1} << 16U);
  for (std::size_t n = 0; (n = std::fread(block.data(), 1, block.size(), stdin)) > 0;) {
    text.insert(text.end(), block.begin(), block.begin() + static_cast<std::ptrdiff_t>(n));
    if (text.size() > most_input) return fail("the file is too large");
  }
  Assimp::Importer importer;
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, !y_up);
  // Vertices are equal to assimp where their normals are too.
  const unsigned joined =
      aiProcess_GenNormals | aiProcess_Triangulate | aiProcess_JoinIdenticalVertices | aiProcess_SortByPType;
  const aiScene* scene = importer.ReadFileFromMemory(text.data(), text.size(), y_up ? joined : 0U, ending);
  if (scene == nullptr) return fail(importer.GetErrorString());
  Soup soup;
  if (scene->mRootNode != nullptr) soup.add(*scene, *scene->mRootNode, aiMatrix4x4());
  std::printf("OFF\n%zu %zu 0\n", soup.vertices.size(), soup.faces.size());
  for (const aiVector3D& p : soup.vertices) {
    std::printf("%.9g %.9g %.9g\n", static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z));
  }
  for (const auto& corners : soup.faces) {
    std::printf("%zu", corners.size());
    for (const std::size_t corner : corners) std::printf(" %zu", corner);
    std::printf("\n");
  }
  return std::fflush(stdout) == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  const bool y_up = argc == 3 && std::strcmp(argv[2], "y-up") == 0;
  if (argc != 2 && !y_up) {
    std::fprintf(stderr, "usage: trellis-mesh ENDING [y-up] <FILE: prints a mesh as OFF\n");
    return 2;
  }
  limit(RLIMIT_AS, most_memory);
  limit(RLIMIT_CPU, most_time);
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_FSIZE, 0);  // output is a pipe
  try {
    return convert(argv[1], y_up);
  } catch (const std::exception& e) {
    return fail(e.what());
  }
}
