#include "nodes/cli/up/command_line.hpp"

#include <algorithm>
#include <fstream>
#include <string_view>

#include <fmt/format.h>

#include "nodes/runtime/node_registry.hpp"

namespace voxtouch::cli {
namespace {

std::string quoted(const std::string& word) {
  const auto plain = [](char c) {
    constexpr std::string_view kPlain =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789@%+=:,./_-";
    return kPlain.find(c) != kPlain.npos;
  };
  if (!word.empty() && std::ranges::all_of(word, plain))
    return word;
  std::string out = "'";
  for (const char c : word)
    out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

}  // namespace

std::map<std::string, std::string> command_words(const std::vector<std::string>& words,
                                                 const std::string& folder) {
  constexpr std::size_t kMaxPieces = 64, kPiece = runtime::NodeRegistry::kMaxTextBytes;
  std::string line;
  for (const std::string& word : words)
    line += (line.empty() ? "" : " ") + quoted(word);
  std::map<std::string, std::string> out{{"folder", folder}};
  for (std::size_t at = 0, number = 0; at < line.size() && line.size() <= kMaxPieces * kPiece;
       at += kPiece, ++number)
    out[fmt::format("command_{:02}", number)] = line.substr(at, kPiece);
  return out;
}

std::vector<std::string> own_words() {
  std::ifstream in("/proc/self/cmdline", std::ios::binary);
  std::vector<std::string> words;
  for (std::string word; std::getline(in, word, '\0');)
    words.push_back(word);
  return words;
}

}  // namespace voxtouch::cli
