// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/ply_reader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "ply_body.h"
#include "ply_header.h"
#include "soup_normals.h"
#include "text_file.h"

namespace vrc {
namespace {

// Where the scalars of a vertex go: x y z, nx ny nz, u v.
constexpr std::size_t kSlots = 8;
constexpr std::size_t kNoSlot = kSlots;
constexpr std::array<std::string_view, 6> kSlotNames{"x", "y", "z", "nx", "ny", "nz"};
constexpr std::array<std::array<std::string_view, 2>, 3> kUvNames{
    {{"u", "v"}, {"s", "t"}, {"texture_u", "texture_v"}}};

const PlyElement* find_element(const PlyHeader& header, std::string_view name) {
  for (const PlyElement& element : header.elements) {
    if (element.name == name) return &element;
  }
  return nullptr;
}

bool has_scalar(const PlyElement& element, std::string_view name) {
  return std::any_of(element.properties.begin(), element.properties.end(),
                     [&](const PlyProperty& p) { return p.name == name && !p.count_type; });
}

// What the vertices of a file carry, and the slot of each of their properties.
struct VertexLayout {
  bool has_normals = false;
  bool has_uvs = false;
  std::vector<std::size_t> slots;
};

VertexLayout vertex_layout(const std::string& file, const PlyElement& vertex) {
  for (const std::string_view axis : {"x", "y", "z"}) {
    if (has_scalar(vertex, axis)) continue;
    throw InputError(file, vertex.line,
                     fmt::format("element 'vertex' has no scalar property '{}'; add it", axis));
  }
  VertexLayout layout;
  layout.has_normals = has_scalar(vertex, "nx") && has_scalar(vertex, "ny") && has_scalar(vertex, "nz");
  const auto uv = std::find_if(kUvNames.begin(), kUvNames.end(), [&](const auto& names) {
    return has_scalar(vertex, names[0]) && has_scalar(vertex, names[1]);
  });
  layout.has_uvs = uv != kUvNames.end();
  for (const PlyProperty& property : vertex.properties) {
    const auto name = std::find(kSlotNames.begin(), kSlotNames.end(), property.name);
    std::size_t slot =
        name == kSlotNames.end() ? kNoSlot : static_cast<std::size_t>(name - kSlotNames.begin());
    if (slot >= 3 && !layout.has_normals) slot = kNoSlot;
    if (layout.has_uvs && property.name == (*uv)[0]) slot = 6;
    if (layout.has_uvs && property.name == (*uv)[1]) slot = 7;
    layout.slots.push_back(slot);
  }
  return layout;
}

// The list of vertex indices of a face or strip, as its place among the properties.
std::size_t index_list(const std::string& file, const PlyElement& element) {
  for (const std::string_view name : {"vertex_indices", "vertex_index"}) {
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
      const PlyProperty& property = element.properties[i];
      if (property.name == name && property.count_type && is_integer(property.type)) return i;
    }
  }
  throw InputError(file, element.line,
                   fmt::format("element '{}' has no list 'vertex_indices' of an integer type; add it, as in "
                               "'property list uchar int vertex_indices'",
                               element.name));
}

template <typename Body>
void skip_property(Body& body, const PlyProperty& property) {
  const std::uint64_t count = property.count_type ? body.list_length(property) : 1;
  body.skip(property.type, count);
}

template <typename Body>
void skip_element(Body& body, const PlyElement& element) {
  if (element.properties.empty()) return;  // Its rows occupy nothing, however many are promised.
  for (std::uint64_t row = 0; row < element.count; ++row) {
    body.begin_row(element, row);
    for (const PlyProperty& property : element.properties) skip_property(body, property);
    body.end_row();
  }
}

template <typename Body>
void read_vertices(Body& body, const PlyElement& element, PolygonSoup& soup) {
  const VertexLayout layout = vertex_layout(soup.source, element);
  soup.positions.reserve(element.count);
  if (layout.has_normals) soup.normals.reserve(element.count);
  if (layout.has_uvs) soup.uvs.reserve(element.count);
  std::array<double, kSlots> values{};
  for (std::uint64_t row = 0; row < element.count; ++row) {
    body.begin_row(element, row);
    for (std::size_t i = 0; i < layout.slots.size(); ++i) {
      const PlyProperty& property = element.properties[i];
      if (layout.slots[i] == kNoSlot) {
        skip_property(body, property);
        continue;
      }
      const double value = body.scalar(property.type);
      const double limit = layout.slots[i] < 3 ? kMaxCoordinate : std::numeric_limits<double>::max();
      if (!(std::abs(value) <= limit)) {
        body.fail(fmt::format("'{}' is {}, which is not finite or above 1e18; repair the mesh", property.name,
                              value));
      }
      values[layout.slots[i]] = value;
    }
    body.end_row();
    soup.positions.emplace_back(values[0], values[1], values[2]);
    if (layout.has_normals) soup.normals.emplace_back(values[3], values[4], values[5]);
    if (layout.has_uvs) soup.uvs.emplace_back(values[6], values[7]);
  }
}

template <typename Body>
std::uint32_t checked_index(Body& body, double index, std::uint64_t vertex_count) {
  if (!(index >= 0.0 && index < static_cast<double>(vertex_count))) {
    body.fail(fmt::format("vertex index {} is out of range; the file has {} vertices, counted from 0", index,
                          vertex_count));
  }
  return static_cast<std::uint32_t>(index);
}

template <typename Body>
void close_face(Body& body, PolygonSoup& soup) {
  if (soup.corner_position.size() >= kInvalidIndex) body.fail("more than 2^32 corners; split the mesh");
  soup.face_begin.push_back(static_cast<std::uint32_t>(soup.corner_position.size()));
}

template <typename Body>
void read_faces(Body& body, const PlyElement& element, std::uint64_t vertex_count, PolygonSoup& soup) {
  const std::size_t indices = index_list(soup.source, element);
  soup.face_begin.reserve(soup.face_begin.size() + element.count);
  soup.corner_position.reserve(soup.corner_position.size() + 3 * element.count);
  for (std::uint64_t row = 0; row < element.count; ++row) {
    body.begin_row(element, row);
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
      const PlyProperty& property = element.properties[i];
      if (i != indices) {
        skip_property(body, property);
        continue;
      }
      const std::uint64_t corners = body.list_length(property);
      if (corners < 3) body.fail(fmt::format("a face with {} corners; it needs at least 3", corners));
      for (std::uint64_t corner = 0; corner < corners; ++corner) {
        soup.corner_position.push_back(checked_index(body, body.scalar(property.type), vertex_count));
      }
      close_face(body, soup);
    }
    body.end_row();
  }
}

// Every vertex after the first two closes a triangle with its two predecessors; -1 begins anew.
// Triangles that repeat a vertex only turn the strip and are no faces.
template <typename Body>
void read_strip(Body& body, const PlyProperty& list, std::uint64_t vertex_count, PolygonSoup& soup) {
  const std::uint64_t length = body.list_length(list);
  std::array<std::uint32_t, 2> previous{};
  std::uint64_t since_restart = 0;
  for (std::uint64_t i = 0; i < length; ++i) {
    const double value = body.scalar(list.type);
    if (value == -1.0) {
      since_restart = 0;
      continue;
    }
    const std::uint32_t index = checked_index(body, value, vertex_count);
    const bool distinct = previous[0] != previous[1] && previous[0] != index && previous[1] != index;
    if (since_restart >= 2 && distinct) {
      const std::size_t flip = since_restart % 2;  // Every second triangle runs the other way round.
      soup.corner_position.insert(soup.corner_position.end(), {previous[flip], previous[1 - flip], index});
      close_face(body, soup);
    }
    previous = {previous[1], index};
    ++since_restart;
  }
}

template <typename Body>
void read_strips(Body& body, const PlyElement& element, std::uint64_t vertex_count, PolygonSoup& soup) {
  const std::size_t indices = index_list(soup.source, element);
  for (std::uint64_t row = 0; row < element.count; ++row) {
    body.begin_row(element, row);
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
      if (i == indices) {
        read_strip(body, element.properties[i], vertex_count, soup);
      } else {
        skip_property(body, element.properties[i]);
      }
    }
    body.end_row();
  }
}

void require_surface(const std::string& file, const PlyHeader& header) {
  const PlyElement* vertex = find_element(header, "vertex");
  if (vertex == nullptr) {
    throw InputError(file, 0, "the header has no element 'vertex'; export a mesh with vertices and faces");
  }
  if (vertex->count >= kInvalidIndex) {
    throw InputError(file, vertex->line, "more than 2^32 vertices; split the mesh");
  }
  if (find_element(header, "face") != nullptr || find_element(header, "tristrips") != nullptr) return;
  if (find_element(header, "range_grid") != nullptr) {
    throw InputError(file, 0,
                     "a range grid (a depth scan) has no faces; convert it to a triangle mesh first");
  }
  throw InputError(file, 0, "a point cloud has no faces; reconstruct a mesh from it first");
}

template <typename Body>
PolygonSoup read_body(Body body, const std::string& file, const PlyHeader& header) {
  PolygonSoup soup;
  soup.source = file;
  soup.face_begin.push_back(0);
  const std::uint64_t vertex_count = find_element(header, "vertex")->count;
  for (const PlyElement& element : header.elements) {
    if (element.name == "vertex") {
      read_vertices(body, element, soup);
    } else if (element.name == "face") {
      read_faces(body, element, vertex_count, soup);
    } else if (element.name == "tristrips") {
      read_strips(body, element, vertex_count, soup);
    } else {
      skip_element(body, element);
    }
  }
  body.finish();
  return soup;
}

}  // namespace

PolygonSoup read_ply(const std::filesystem::path& path) {
  const std::string file = path.string();
  const std::string text = read_whole_file(path);
  const PlyHeader header = parse_ply_header(file, text);
  require_surface(file, header);
  check_counts(file, header);
  PolygonSoup soup = header.format == PlyFormat::kAscii
                         ? read_body(AsciiPlyBody(file, header), file, header)
                         : read_body(BinaryPlyBody(file, header), file, header);
  if (soup.face_count() == 0) {
    throw InputError(file, 0,
                     "a point cloud: the file has vertices but no face; reconstruct a mesh from it first");
  }
  // PLY has one normal and one texture coordinate per vertex.
  if (!soup.normals.empty()) soup.corner_normal = soup.corner_position;
  if (!soup.uvs.empty()) soup.corner_uv = soup.corner_position;
  normalize_normals(soup);
  return soup;
}

}  // namespace vrc
