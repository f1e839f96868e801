// SPDX-License-Identifier: GPL-3.0-or-later
// Times reading a wavy grid of a million triangles from OBJ, ascii PLY and binary PLY.
#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <system_error>

#include "io/obj_reader.h"
#include "io/ply_reader.h"

namespace vrc {
namespace {

constexpr int kCells = 708;  // Along each side; two triangles in each cell.
constexpr int kVertices = (kCells + 1) * (kCells + 1);
constexpr int kTriangles = 2 * kCells * kCells;

// Calls vertex(x, y, z) for all vertices.
template <typename Vertex>
void each_vertex(Vertex&& vertex) {
  for (int j = 0; j <= kCells; ++j) {
    for (int i = 0; i <= kCells; ++i) {
      const double x = static_cast<double>(i) / kCells;
      const double y = static_cast<double>(j) / kCells;
      vertex(x, y, 0.1 * std::sin(20.0 * x) * std::cos(17.0 * y));
    }
  }
}

// Calls triangle(a, b, c) for all triangles, with indices from 0.
template <typename Triangle>
void each_triangle(Triangle&& triangle) {
  for (int j = 0; j < kCells; ++j) {
    for (int i = 0; i < kCells; ++i) {
      const int a = j * (kCells + 1) + i;
      const int b = a + kCells + 1;
      triangle(a, a + 1, b + 1);
      triangle(a, b + 1, b);
    }
  }
}

std::string obj_text() {
  std::string text;
  auto out = std::back_inserter(text);
  each_vertex(
      [&](double x, double y, double z) { fmt::format_to(out, "v {:.7f} {:.7f} {:.7f}\n", x, y, z); });
  each_triangle([&](int a, int b, int c) { fmt::format_to(out, "f {} {} {}\n", a + 1, b + 1, c + 1); });
  return text;
}

std::string ply_header(std::string_view format) {
  return fmt::format(
      "ply\nformat {} 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
      "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
      format, kVertices, kTriangles);
}

std::string ascii_ply_text() {
  std::string text = ply_header("ascii");
  auto out = std::back_inserter(text);
  each_vertex([&](double x, double y, double z) { fmt::format_to(out, "{:.7f} {:.7f} {:.7f}\n", x, y, z); });
  each_triangle([&](int a, int b, int c) { fmt::format_to(out, "3 {} {} {}\n", a, b, c); });
  return text;
}

std::string binary_ply_text() {
  std::string text = ply_header("binary_little_endian");  // As are the machines that this runs on.
  const auto append = [&](auto value) {
    char bytes[sizeof(value)];
    std::memcpy(bytes, &value, sizeof(value));
    text.append(bytes, sizeof(value));
  };
  each_vertex([&](double x, double y, double z) {
    for (const double value : {x, y, z}) append(static_cast<float>(value));
  });
  each_triangle([&](int a, int b, int c) {
    text.push_back(3);
    for (const int index : {a, b, c}) append(index);
  });
  return text;
}

// A file in the temporary folder for the time of one benchmark.
class TemporaryFile {
 public:
  TemporaryFile(const std::string& extension, const std::string& content)
      : path_(std::filesystem::temp_directory_path() /
              fmt::format("vrc_bench_mesh_load_{}{}", ::getpid(), extension)),
        size_(content.size()) {
    std::ofstream out(path_, std::ios::binary);
    out.write(content.data(), static_cast<std::streamsize>(content.size()));
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] std::size_t size() const { return size_; }

 private:
  std::filesystem::path path_;
  std::size_t size_;
};

template <typename Read>
void time_reading(benchmark::State& state, const TemporaryFile& file, Read&& read) {
  for (auto _ : state) {
    if (read(file.path()) != kTriangles) state.SkipWithError("triangles are missing");
  }
  state.SetItemsProcessed(state.iterations() * kTriangles);
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(file.size()));
}

std::size_t ply_face_count(const std::filesystem::path& path) { return read_ply(path).face_count(); }

void read_obj_million(benchmark::State& state) {
  const TemporaryFile file(".obj", obj_text());
  time_reading(state, file, [](const auto& path) { return read_obj(path).soup.face_count(); });
}
BENCHMARK(read_obj_million)->Unit(benchmark::kMillisecond);

void read_ascii_ply_million(benchmark::State& state) {
  time_reading(state, TemporaryFile("_ascii.ply", ascii_ply_text()), ply_face_count);
}
BENCHMARK(read_ascii_ply_million)->Unit(benchmark::kMillisecond);

void read_binary_ply_million(benchmark::State& state) {
  time_reading(state, TemporaryFile("_binary.ply", binary_ply_text()), ply_face_count);
}
BENCHMARK(read_binary_ply_million)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace vrc

BENCHMARK_MAIN();
