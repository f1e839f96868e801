// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/deflate.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include "io/base64.h"
#include "support.h"

namespace vrc {
namespace {

std::string inflated(const std::string& stream, std::size_t size) {
  std::string bytes(size + 1, '\0');
  uLongf length = bytes.size();
  EXPECT_EQ(uncompress(reinterpret_cast<Bytef*>(bytes.data()), &length,
                       reinterpret_cast<const Bytef*>(stream.data()), stream.size()),
            Z_OK);
  bytes.resize(length);
  return bytes;
}

TEST(Deflate, GivesBackTheBytes) {
  test::SeededBits bits(7);
  std::string noise(10000, '\0');
  for (char& c : noise) c = static_cast<char>(bits.next());
  for (const std::string& bytes : {std::string(), std::string(1, '\0'), std::string(100000, 'a'), noise}) {
    const std::string stream = deflated(bytes);
    EXPECT_EQ(inflated(stream, bytes.size()), bytes);
    EXPECT_EQ(deflated(bytes), stream);
  }
  EXPECT_LT(deflated(std::string(100000, 'a')).size(), 200u);
}

TEST(Base64, FollowsTheExamplesOfItsStandard) {  // RFC 4648, section 10
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foob"), "Zm9vYg==");
  EXPECT_EQ(base64("fooba"), "Zm9vYmE=");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64("\xfb\xff"), "+/8=");
}

}  // namespace
}  // namespace vrc
