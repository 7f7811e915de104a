// SPDX-License-Identifier: GPL-3.0-or-later
// trellis-mesh ENDING: reads a file in a format of assimp from standard input and prints its polygons as OFF, in metres
// where the file states its unit. A process of its own because assimp may write beyond its memory on damaged files:
// the reader of meshes (reader/mesh_dae.cpp) starts it and trusts nothing that it prints.
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <sys/resource.h>

#include <assimp/Importer.hpp>
#include <cstdio>
#include <cstdlib>
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

int convert(const char* ending) {
  std::vector<char> text;
  std::vector<char> block(std::size_t{1} << 16U);
  for (std::size_t n = 0; (n = std::fread(block.data(), 1, block.size(), stdin)) > 0;) {
    text.insert(text.end(), block.begin(), block.begin() + static_cast<std::ptrdiff_t>(n));
    if (text.size() > most_input) return fail("the file is too large");
  }
  Assimp::Importer importer;
  // Coordinates stay in the file's axes, as other programs for robots have them.
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const aiScene* scene = importer.ReadFileFromMemory(text.data(), text.size(), aiProcess_PreTransformVertices, ending);
  if (scene == nullptr) return fail(importer.GetErrorString());
  std::size_t vertices = 0;
  std::size_t faces = 0;
  for (unsigned m = 0; m < scene->mNumMeshes; ++m) {
    vertices += scene->mMeshes[m]->mNumVertices;
    for (unsigned f = 0; f < scene->mMeshes[m]->mNumFaces; ++f) {
      faces += scene->mMeshes[m]->mFaces[f].mNumIndices >= 3 ? 1U : 0U;  // without points and lines
    }
  }
  std::printf("OFF\n%zu %zu 0\n", vertices, faces);
  for (unsigned m = 0; m < scene->mNumMeshes; ++m) {
    for (unsigned v = 0; v < scene->mMeshes[m]->mNumVertices; ++v) {
      const aiVector3D& p = scene->mMeshes[m]->mVertices[v];
      std::printf("%.9g %.9g %.9g\n", static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z));
    }
  }
  std::size_t first = 0;
  for (unsigned m = 0; m < scene->mNumMeshes; ++m) {
    for (unsigned f = 0; f < scene->mMeshes[m]->mNumFaces; ++f) {
      const aiFace& face = scene->mMeshes[m]->mFaces[f];
      if (face.mNumIndices < 3) continue;
      std::printf("%u", face.mNumIndices);
      for (unsigned i = 0; i < face.mNumIndices; ++i) std::printf(" %zu", first + face.mIndices[i]);
      std::printf("\n");
    }
    first += scene->mMeshes[m]->mNumVertices;
  }
  return std::fflush(stdout) == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: trellis-mesh ENDING <FILE: prints a mesh as OFF\n");
    return 2;
  }
  limit(RLIMIT_AS, most_memory);
  limit(RLIMIT_CPU, most_time);
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_FSIZE, 0);  // output is a pipe
  try {
    return convert(argv[1]);
  } catch (const std::exception& e) {
    return fail(e.what());
  }
}
