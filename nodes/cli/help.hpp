#pragma once
/// Output of --help for each verb: a summary line, details with examples, and options in groups.

namespace CLI {
class App;
}

namespace voxtouch::cli {

/// Sets summary, details and option groups of every verb of `app`. std::logic_error if a verb has
/// none.
void describe_verbs(CLI::App& app);

}  // namespace voxtouch::cli
