// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <exception>
#include <filesystem>
#include <string>
#include <string_view>
#include <typeinfo>
#include <utility>

#include "core/error.h"
#include "support.h"

namespace vrc::test {

/// The message of the InputError that `call` throws; fails the test when it does not throw one.
template <typename Call>
std::string input_error_of(Call&& call) {
  try {
    std::forward<Call>(call)();
    ADD_FAILURE() << "no error was thrown";
    return {};
  } catch (const InputError& error) {
    return error.what();
  }
}

/// A damaged copy of `text`: one to three cuts, flipped bits, repeated or lost stretches, or words
/// that parsers stumble over.
inline std::string mutated(std::string text, SeededBits& bits) {
  constexpr std::array<std::string_view, 22> kWords{
      "nan",   "-inf", "1e999", "1e-999", "-1",  "0",  "4294967296", "99999999999999999999",
      " ",     "\n",   "\r\n",  "\\\n",   "/",   "//", "#",          "f 1 1 1\n",
      "v 1\n", "list", "\xFF",  "-",      "1e5", "."};
  for (std::size_t edits = 1 + bits.below(3); edits > 0 && !text.empty(); --edits) {
    const std::size_t at = bits.below(text.size());
    switch (bits.below(6)) {
      case 0:
        text.resize(at);
        break;
      case 1:
        text[at] = static_cast<char>(text[at] ^ (1 << bits.below(8)));
        break;
      case 2:
        text.insert(at, kWords[bits.below(kWords.size())]);
        break;
      case 3:
        text.insert(at, std::string(text, at, 1 + bits.below(24)));
        break;
      case 4:
        text.erase(at, 1 + bits.below(24));
        break;
      default:
        text[at] = static_cast<char>(bits.below(256));
    }
  }
  return text;
}

/// Feeds `rounds` damaged copies of `text` to `read_and_validate(path)`, which must either succeed
/// or throw InputError. Returns how many were accepted.
template <typename Read>
int count_accepted_mutations(const std::string& text, int rounds, std::uint64_t seed,
                             Read&& read_and_validate) {
  const TempDir folder;
  SeededBits bits(seed);
  int accepted = 0;
  for (int round = 0; round < rounds; ++round) {
    const std::string damaged = mutated(text, bits);
    const auto path = write_file(folder / "mutated", damaged);
    try {
      read_and_validate(path);
      ++accepted;
    } catch (const InputError&) {
    } catch (const std::exception& error) {
      ADD_FAILURE() << "round " << round << ": " << typeid(error).name() << ": " << error.what() << "\n"
                    << damaged;
    }
    std::filesystem::remove(path);  // Rewriting a file in place is slow where that forces it to disk.
  }
  return accepted;
}

}  // namespace vrc::test
