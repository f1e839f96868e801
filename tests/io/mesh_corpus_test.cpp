// SPDX-License-Identifier: GPL-3.0-or-later
// Files as they occur in the wild, from the reader to the repaired mesh: either all of the surface
// arrives, or the file is refused.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "geometry/surface_mesh.h"
#include "io/obj_reader.h"
#include "io/ply_reader.h"
#include "reader_support.h"

namespace vrc {
namespace {

using testing::HasSubstr;

struct Arrives {
  std::string name;
  std::string text;
  std::size_t faces;
  double area;
};

struct Refused {
  std::string name;
  std::string text;
  std::string message;
};

constexpr const char* kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

SurfaceMesh load(const test::TempDir& folder, const std::string& text) {
  const bool ply = text.rfind("ply", 0) == 0;
  const auto path = test::write_file(folder / (ply ? "mesh.ply" : "mesh.obj"), text);
  return build_surface_mesh(ply ? read_ply(path) : read_obj(path).soup);
}

std::string ply_file(const std::string& header, const std::string& body) {
  return "ply\nformat ascii 1.0\n" + header + "end_header\n" + body;
}

std::string vertices(int count) {
  return "element vertex " + std::to_string(count) +
         "\nproperty float x\nproperty float y\nproperty float z\n";
}

std::vector<Arrives> sound_files() {
  const std::string square = kSquare;
  const std::string ply_square = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
  return {
      {"zero normals", square + "vn 0 0 0\nf 1//1 2//1 3//1 4//1\n", 2, 1.0},
      {"normals on faces without area",
       square + "v 2 0 0\nvn 0 0 1\nf 1//1 2//1 5//1\nf 1//1 2//1 3//1 4//1\n", 2, 1.0},
      {"faces without area and without normals", square + "v 2 0 0\nf 1 2 5\nf 1 1 2\nf 1 2 3 4\n", 2, 1.0},
      {"negative indices", square + "f -4 -3 -2 -1\n", 2, 1.0},
      {"a missing material library", "mtllib gone.mtl\nusemtl gone\n" + square + "f 1 2 3 4\n", 2, 1.0},
      {"corners with and without uv", square + "vt 0 0\nvt 1 0\nvt 1 1\nf 1/1 2/2 3/3\nf 1 3 4\n", 2, 1.0},
      {"one face with and without uv", square + "vt 0 0\nf 1/1 2 3/1 4\n", 2, 1.0},
      {"a concave arrow", "v 0 0 0\nv 2 -1 0\nv 0.5 0 0\nv 2 1 0\nf 1 2 3 4\n", 2, 0.5},
      {"a concave L", "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nf 1 2 3 4 5 6\n", 4, 3.0},
      {"a polygon with a doubled corner", square + "f 1 2 2 3 4\n", 2, 1.0},
      {"duplicate faces", square + "f 1 2 3 4\nf 2 3 4 1\nf 4 3 2 1\n", 2, 1.0},
      {"faces doubled by doubled vertices", square + square + "f 1 2 3 4\nf 5 6 7 8\n", 2, 1.0},
      {"points and lines among faces", square + "p 1\nl 1 2 3\nf 1 2 3\np 2 3\nf 1 3 4\nl 4 1\n", 2, 1.0},
      {"vertex_index",
       ply_file(vertices(4) + "element face 1\nproperty list uchar int vertex_index\n",
                ply_square + "4 0 1 2 3\n"),
       2, 1.0},
      {"edges beside faces",
       ply_file(vertices(4) + "element face 1\nproperty list uchar int vertex_indices\nelement edge "
                              "1\nproperty int vertex1\nproperty int vertex2\n",
                ply_square + "4 0 1 2 3\n0 1\n"),
       2, 1.0},
      {"triangle strips",
       ply_file(vertices(4) + "element tristrips 1\nproperty list int int vertex_indices\n",
                "0 0 0\n1 0 0\n0 1 0\n1 1 0\n6 0 1 2 3 -1 0\n"),
       2, 1.0},
  };
}

std::vector<Refused> broken_files() {
  const std::string square = kSquare;
  const std::string faces = "element face 1\nproperty list uchar int vertex_indices\n";
  const std::string ply_square = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
  return {
      {"OBJ: not a number", "v 0 0 nan\n" + square + "f 1 2 3\n", "not a finite number"},
      {"OBJ: normal 0", square + "vn 0 0 1\nf 1//0 2//1 3//1\n", "index 0"},
      {"OBJ: far away", square + "v 1.8e18 0 0\nf 1 2 5\n", "1e18"},
      {"OBJ: far back", square + "f -9 -2 -1\n", "does not exist"},
      {"OBJ: points and lines only", square + "p 1\nl 1 2\n", "no faces"},
      {"PLY: not a number", ply_file(vertices(4) + faces, "0 0 0\n1 nan 0\n1 1 0\n0 1 0\n4 0 1 2 3\n"),
       "not a finite number"},
      {"PLY: ends under its header", ply_file(vertices(4) + faces, ""), "the file ends after 0"},
      {"PLY: counts too many", ply_file(vertices(400000000) + faces, ply_square + "4 0 1 2 3\n"),
       "the file ends after"},
      {"PLY: a range grid",
       ply_file(vertices(4) + "element range_grid 4\nproperty list uchar int vertex_indices\n",
                ply_square + "1 0\n1 1\n1 2\n1 3\n"),
       "range grid"},
      {"PLY: far away", ply_file(vertices(4) + faces, "0 0 0\n1 0 0\n1 1.9e18 0\n0 1 0\n4 0 1 2 3\n"),
       "1e18"},
      {"PLY: a strip out of range",
       ply_file(vertices(4) + "element tristrips 1\nproperty list int int vertex_indices\n",
                ply_square + "4 0 1 2 9\n"),
       "out of range"},
  };
}

TEST(MeshCorpus, AllOfTheSurfaceArrives) {
  const test::TempDir folder;
  for (const Arrives& file : sound_files()) {
    SCOPED_TRACE(file.name);
    const SurfaceMesh mesh = load(folder, file.text);
    EXPECT_EQ(mesh.face_count(), file.faces);
    EXPECT_NEAR(mesh.report().area, file.area, 1e-12);
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
      EXPECT_NEAR(mesh.face_normal(f).z(), 1.0, 1e-12);
      for (int k = 0; k < 3; ++k) {
        EXPECT_NEAR(mesh.corner_normal(f, k).z(), 1.0, 1e-12);
        EXPECT_TRUE(mesh.corner_uv(f, k).allFinite());
      }
    }
  }
}

TEST(MeshCorpus, BrokenFilesAreRefused) {
  const test::TempDir folder;
  for (const Refused& file : broken_files()) {
    SCOPED_TRACE(file.name);
    EXPECT_THAT(test::input_error_of([&] { (void)load(folder, file.text); }), HasSubstr(file.message));
  }
}

}  // namespace
}  // namespace vrc
