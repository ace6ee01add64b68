#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <system_error>

#include "tests/experiments/hostile_meshes/attempt.hpp"

namespace voxtouch::hostile {
namespace {

constexpr std::array<const char*, 7> kNames = {"touched", "refused",     "not finite", "no contact",
                                               "unnamed", "out of time", "crashed"};

std::string format_of(const Verdict& v) {
  std::string e = v.file.extension().string();
  for (char& c : e)
    c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  const std::array<const char*, 6> known = {".obj", ".stl", ".ply", ".gltf", ".glb", ".dae"};
  return std::find(known.begin(), known.end(), e) == known.end() ? "all others" : e.substr(1);
}

/// "mesh '<path>': <reason>; <remedy>" without path, remedy and figures, to group equal reasons.
std::string reason_of(const Verdict& v) {
  std::string text = v.sentence;
  if (const std::size_t at = text.find("': ");
      text.starts_with("mesh '") && at != std::string::npos)
    text.erase(0, at + 3);
  if (text.starts_with("the format '"))
    return "the format is not known";
  if (const std::size_t at = text.rfind("; "); at != std::string::npos)
    text.resize(at);
  std::string plain;
  for (std::size_t n = 0; n < text.size(); ++n) {
    const bool digit = std::isdigit(static_cast<unsigned char>(text[n])) != 0;
    if (digit && !plain.empty() && plain.back() == '#')
      continue;
    plain += digit ? '#' : text[n] == '|' || text[n] == '\n' ? ' ' : text[n];
  }
  return plain;
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text)
    out += c == '"' ? "\"\"" : c == '\n' ? std::string(" ") : std::string(1, c);
  return out + "\"";
}

}  // namespace

std::string name_of(Outcome outcome) { return kNames[static_cast<std::size_t>(outcome)]; }

std::vector<std::filesystem::path> files_below(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  std::error_code error;
  for (std::filesystem::recursive_directory_iterator at(folder, error), end; !error && at != end;
       at.increment(error))
    if (at->is_regular_file(error))
      files.push_back(at->path());
  std::sort(files.begin(), files.end());
  return files;
}

std::string as_markdown(const std::vector<Verdict>& verdicts) {
  std::map<std::string, std::array<std::size_t, kNames.size() + 1>> formats;
  std::map<std::string, std::vector<std::string>> reasons;
  for (const Verdict& v : verdicts) {
    for (const std::string& row : {format_of(v), std::string("total")}) {
      ++formats[row][static_cast<std::size_t>(v.outcome)];
      ++formats[row].back();
    }
    if (v.outcome != Outcome::kTouched)
      reasons[v.outcome == Outcome::kRefused
                  ? reason_of(v)
                  : fmt::format("**{}**: {}", name_of(v.outcome), reason_of(v))]
          .push_back(v.file.filename().string());
  }
  std::string text = "| format | files |";
  for (const char* name : kNames)
    text += fmt::format(" {} |", name);
  text += "\n|---|---|---|---|---|---|---|---|---|\n";
  for (const auto& [format, counts] : formats) {
    text += fmt::format("| {} | {} |", format, counts.back());
    for (std::size_t n = 0; n < kNames.size(); ++n)
      text += fmt::format(" {} |", counts[n]);
    text += "\n";
  }
  text += "\n| files | why (`#` stands for a figure) | which |\n|---|---|---|\n";
  for (const auto& [reason, files] : reasons) {
    text += fmt::format("| {} | {} |", files.size(), reason);
    for (std::size_t n = 0; n < std::min<std::size_t>(files.size(), 6); ++n)
      text += fmt::format("{} `{}`", n ? "," : "", files[n]);
    text += files.size() > 6 ? ", ... |\n" : " |\n";
  }
  return text;
}

std::string as_csv(const std::vector<Verdict>& verdicts) {
  std::string text = "file,format,outcome,cpu_s,peak_mib,sentence\n";
  for (const Verdict& v : verdicts)
    text += fmt::format("{},{},{},{:.3f},{},{}\n", quoted(v.file.string()), format_of(v),
                        name_of(v.outcome), v.cpu_s, v.peak_mib, quoted(v.sentence));
  return text;
}

}  // namespace voxtouch::hostile
