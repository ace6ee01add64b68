#pragma once
/// Line breaks of --help.

namespace CLI {
class App;
}

namespace voxtouch::runtime {

/// Columns of --help.
inline constexpr int kHelpColumns = 100;

/// Breaks the descriptions of all options of `app` and its subcommands, and the paragraphs below
/// them, into lines of at most kHelpColumns. Indented lines, such as examples, stay as they are.
void wrap_help(CLI::App& app);

}  // namespace voxtouch::runtime
