// SPDX-FileCopyrightText: 2026 The semantic_vslam authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fuzz/mutator.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstring>
#include <limits>

namespace semantic_vslam {
namespace {

constexpr std::size_t kLongestPiece = 4096;

template <class T>
std::string bytesOf(T value) {
  return {reinterpret_cast<const char*>(&value), sizeof(value)};
}

}  // namespace

std::string Mutator::damaged(std::string content, const std::vector<std::string>& others) {
  for (std::size_t times = 1 + below(6); times > 0; --times) damageOnce(content, others);
  return content;
}

void Mutator::damageOnce(std::string& content, const std::vector<std::string>& others) {
  const std::size_t at = below(content.size() + 1);
  const std::size_t left = content.size() - at;
  const std::size_t piece = 1 + below(std::min<std::size_t>(below(2) == 0 ? 16 : kLongestPiece, left));
  switch (below(10)) {
    case 0:
      if (left > 0) content[at] = static_cast<char>(content[at] ^ (1 << below(8)));
      break;
    case 1:
      if (left > 0) content[at] = static_cast<char>(below(256));
      break;
    case 2: content.erase(at, piece); break;
    case 3: content.insert(at, content.substr(at, piece)); break;
    case 4:
      for (std::size_t times = 1 + below(16); times > 0; --times) content.insert(at, 1, static_cast<char>(below(256)));
      break;
    case 5: {
      const std::string& other = others[below(others.size())];
      content.replace(at, std::min(piece, left), other.substr(below(other.size() + 1), piece));
      break;
    }
    case 6: content.resize(at); break;
    case 7:
    case 8: replaceWrittenNumber(content); break;
    default: overwriteNumber(content);
  }
}

void Mutator::overwriteNumber(std::string& content) {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  const std::array<std::string, 18> numbers{bytesOf(std::uint64_t{0}),
                                            bytesOf(~std::uint64_t{0}),
                                            bytesOf(std::uint64_t{1} << 63),
                                            bytesOf(std::uint64_t{1} << 40),
                                            bytesOf(std::uint32_t{0}),
                                            bytesOf(~std::uint32_t{0}),
                                            bytesOf(std::uint32_t{1} << 31),
                                            bytesOf(std::uint32_t{0x7FFFFFFF}),
                                            bytesOf(std::uint16_t{0xFFFF}),
                                            bytesOf(std::nan("")),
                                            bytesOf(kInf),
                                            bytesOf(-kInf),
                                            bytesOf(1e300),
                                            bytesOf(-1e-300),
                                            bytesOf(std::nanf("")),
                                            bytesOf(static_cast<float>(kInf)),
                                            bytesOf(1e30F),
                                            bytesOf(-1.0F)};
  const std::string& number = numbers[below(numbers.size())];
  if (content.size() < number.size()) return;
  content.replace(below(content.size() - number.size() + 1), number.size(), number);
}

void Mutator::replaceWrittenNumber(std::string& content) {
  static const std::array<const char*, 20> kNumbers{"0",
                                                    "-1",
                                                    "nan",
                                                    ".nan",
                                                    "inf",
                                                    "-inf",
                                                    "1e300",
                                                    "-1e300",
                                                    "1e-300",
                                                    "99999999999999999999",
                                                    "2147483648",
                                                    "-2147483649",
                                                    "18446744073709551615",
                                                    "1e999",
                                                    "0x7f",
                                                    "",
                                                    "~",
                                                    "[]",
                                                    "{a: 1}",
                                                    "*a"};
  const std::size_t from = below(content.size() + 1);
  const auto is_digit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
  const auto begin = std::find_if(content.begin() + static_cast<std::ptrdiff_t>(from), content.end(), is_digit);
  const auto end = std::find_if_not(begin, content.end(), is_digit);
  content.replace(begin, end, kNumbers[below(kNumbers.size())]);
}

}  // namespace semantic_vslam
