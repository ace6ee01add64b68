#include "nodes/runtime/help_layout.hpp"

#include <sstream>
#include <string>

#include <CLI/CLI.hpp>

namespace voxtouch::runtime {
namespace {

constexpr std::size_t kNameColumns = 30;  // column of descriptions in CLI11

/// Joins the words of `text` and breaks it before column `columns`.
std::string wrapped(const std::string& text, std::size_t columns) {
  std::istringstream words(text);
  std::string out, word;
  std::size_t column = 0;
  while (words >> word) {
    if (column > 0 && column + 1 + word.size() > columns) {
      out += '\n';
      column = 0;
    }
    if (column > 0) {
      out += ' ';
      ++column;
    }
    out += word;
    column += word.size();
  }
  return out;
}

bool is_indented(const std::string& line) { return line.empty() || line.front() == ' '; }

/// Wraps each run of lines that begin at column 0.
std::string wrapped_paragraphs(const std::string& text, std::size_t columns) {
  std::istringstream lines(text);
  std::string out, paragraph, line;
  const auto flush = [&] {
    if (!paragraph.empty())
      out += wrapped(paragraph, columns) + '\n';
    paragraph.clear();
  };
  while (std::getline(lines, line)) {
    if (is_indented(line)) {
      flush();
      out += line + '\n';
    } else {
      paragraph += line + ' ';
    }
  }
  flush();
  if (!out.empty())
    out.pop_back();
  return out;
}

}  // namespace

void wrap_help(CLI::App& app) {
  for (CLI::Option* option : app.get_options())
    option->description(wrapped(option->get_description(), kHelpColumns - kNameColumns));
  app.footer(wrapped_paragraphs(app.get_footer(), kHelpColumns));
  for (CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; }))
    wrap_help(*verb);
}

}  // namespace voxtouch::runtime
