// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/deflate.h"

#include <zlib.h>

#include "core/error.h"

namespace vrc {

std::string deflated(std::string_view bytes) {
  uLongf size = compressBound(bytes.size());
  std::string stream(size, '\0');
  const int status =
      compress2(reinterpret_cast<Bytef*>(stream.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
                bytes.size(), Z_BEST_COMPRESSION);
  VRC_CHECK(status == Z_OK, "zlib returned {} for {} bytes", status, bytes.size());
  stream.resize(size);
  return stream;
}

}  // namespace vrc
