#include "tests/unit/scene/schema_checker.hpp"

#include <fstream>
#include <stdexcept>

#include "core/types/number.hpp"
#include "tests/support/process/process.hpp"

namespace voxtouch::test {
namespace {

using Json = nlohmann::json;

Json scalar(const scene::YamlNode& node) {
  if (node.quoted)
    return node.text;
  if (node.text == "true" || node.text == "false")
    return node.text == "true";
  std::string_view digits = node.text;
  if (digits.size() > 1 && digits[0] == '+')
    digits.remove_prefix(1);  // valid in YAML, but not for parse_number
  if (const auto whole = parse_number<std::int64_t>(digits))
    return *whole;
  if (const auto real = parse_number<double>(digits))
    return *real;
  return node.text;
}

}  // namespace

Json to_json(const scene::YamlNode& node) {
  Json out;
  switch (node.kind) {
    case scene::YamlNode::Kind::kNull:
      return nullptr;
    case scene::YamlNode::Kind::kScalar:
      return scalar(node);
    case scene::YamlNode::Kind::kSequence:
      out = Json::array();
      for (const scene::YamlNode& item : node.items)
        out.push_back(to_json(item));
      return out;
    case scene::YamlNode::Kind::kMap:
      out = Json::object();
      for (const scene::YamlEntry& entry : node.entries)
        out[entry.key] = to_json(entry.value);
      return out;
  }
  return out;
}

std::vector<std::vector<std::string>> violations(const Json& schema, const Json& values) {
  const TemporaryFolder folder;
  std::ofstream(folder / "schema.json") << schema;
  std::ofstream(folder / "values.json") << values;
  Process checker({"/usr/bin/python3", "-B", VOXTOUCH_SCHEMA_CHECKER,
                   (folder / "schema.json").string(), (folder / "values.json").string()});
  const Finished end = checker.wait();
  if (end.status != 0)
    throw std::runtime_error(end.err);
  return Json::parse(end.out);
}

}  // namespace voxtouch::test
