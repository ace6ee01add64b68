#include "tests/unit/scene/schema_checker.hpp"

#include <algorithm>
#include <regex>
#include <set>
#include <stdexcept>

#include "core/types/number.hpp"

namespace voxtouch::test {
namespace {

using Json = nlohmann::json;

class Checker {
 public:
  explicit Checker(const Json& root) : root_(root) {}

  void check(const Json& schema, const Json& value, const std::string& at, std::vector<std::string>& out) const {
    for (const auto& [word, rule] : schema.items()) one(schema, word, rule, value, at, out);
  }

 private:
  bool holds(const Json& schema, const Json& value) const {
    std::vector<std::string> out;
    check(schema, value, "", out);
    return out.empty();
  }
  std::size_t holding(const Json& schemas, const Json& value) const {
    std::size_t n = 0;
    for (const Json& schema : schemas) n += holds(schema, value) ? 1 : 0;
    return n;
  }

  void one(const Json& schema, const std::string& word, const Json& rule, const Json& value, const std::string& at,
           std::vector<std::string>& out) const {
    static const std::set<std::string> silent = {"$schema", "$defs", "title", "description", "default", "then", "else"};
    if (silent.contains(word)) return;
    const auto need = [&](bool good) {
      if (!good) out.push_back(at + ": " + word + " " + rule.dump());
    };
    const bool object = value.is_object(), array = value.is_array(), number = value.is_number();
    if (word == "$ref")
      check(root_.at(Json::json_pointer(rule.get<std::string>().substr(1))), value, at, out);
    else if (word == "type")
      need(of_type(rule, value));
    else if (word == "enum")
      need(std::find(rule.begin(), rule.end(), value) != rule.end());
    else if (word == "minimum")
      need(!number || value >= rule);
    else if (word == "maximum")
      need(!number || value <= rule);
    else if (word == "exclusiveMinimum")
      need(!number || value > rule);
    else if (word == "minLength")
      need(!value.is_string() || value.get<std::string>().size() >= rule);
    else if (word == "minItems")
      need(!array || value.size() >= rule);
    else if (word == "maxItems")
      need(!array || value.size() <= rule);
    else if (word == "pattern")
      need(!value.is_string() || std::regex_search(value.get<std::string>(), std::regex(rule)));
    else if (word == "oneOf")
      need(holding(rule, value) == 1);
    else if (word == "allOf") {
      for (const Json& one : rule) check(one, value, at, out);
    } else if (word == "anyOf")
      need(holding(rule, value) > 0);
    else if (word == "not")
      need(!holds(rule, value));
    else if (word == "if")
      branch(schema, rule, value, at, out);
    else if (word == "items") {
      if (array)
        for (std::size_t n = 0; n < value.size(); ++n) check(rule, value[n], at + "/" + std::to_string(n), out);
    } else if (word == "required") {
      if (object)
        for (const Json& key : rule) need(value.contains(key.get<std::string>()));
    } else if (word == "dependentRequired") {
      if (object)
        for (const auto& [key, also] : rule.items())
          if (value.contains(key))
            for (const Json& k : also) need(value.contains(k.get<std::string>()));
    } else if (word == "propertyNames") {
      if (object)
        for (const auto& [key, unused] : value.items()) check(rule, key, at + "/" + key, out);
    } else if (word == "properties") {
      if (object)
        for (const auto& [key, sub] : rule.items())
          if (value.contains(key)) check(sub, value[key], at + "/" + key, out);
    } else if (word == "additionalProperties")
      others(schema, rule, value, at, out);
    else
      throw std::invalid_argument("the schema's word '" + word + "' is not known here");
  }

  void branch(const Json& schema, const Json& rule, const Json& value, const std::string& at,
              std::vector<std::string>& out) const {
    const char* way = holds(rule, value) ? "then" : "else";
    if (schema.contains(way)) check(schema[way], value, at, out);
  }

  void others(const Json& schema, const Json& rule, const Json& value, const std::string& at,
              std::vector<std::string>& out) const {
    if (!value.is_object()) return;
    for (const auto& [key, entry] : value.items()) {
      if (schema.contains("properties") && schema["properties"].contains(key)) continue;
      if (rule == false)
        out.push_back(at + "/" + key + ": no such key");
      else
        check(rule, entry, at + "/" + key, out);
    }
  }

  static bool of_type(const Json& types, const Json& value) {
    if (types.is_array())
      return std::any_of(types.begin(), types.end(), [&](const Json& one) { return of_type(one, value); });
    const std::string type = types;
    if (type == "object") return value.is_object();
    if (type == "array") return value.is_array();
    if (type == "string") return value.is_string();
    if (type == "boolean") return value.is_boolean();
    if (type == "number") return value.is_number();
    if (type == "integer") return value.is_number_integer();
    throw std::invalid_argument("the schema's type '" + type + "' is not known here");
  }

  const Json& root_;
};

Json scalar(const scene::YamlNode& node) {
  if (node.quoted) return node.text;
  if (node.text == "true" || node.text == "false") return node.text == "true";
  std::string_view digits = node.text;
  if (digits.size() > 1 && digits[0] == '+') digits.remove_prefix(1);  // which YAML knows, and parse_number does not
  if (const auto whole = parse_number<std::int64_t>(digits)) return *whole;
  if (const auto real = parse_number<double>(digits)) return *real;
  return node.text;
}

}  // namespace

Json to_json(const scene::YamlNode& node) {
  Json out;
  switch (node.kind) {
    case scene::YamlNode::Kind::kNull: return nullptr;
    case scene::YamlNode::Kind::kScalar: return scalar(node);
    case scene::YamlNode::Kind::kSequence:
      out = Json::array();
      for (const scene::YamlNode& item : node.items) out.push_back(to_json(item));
      return out;
    case scene::YamlNode::Kind::kMap:
      out = Json::object();
      for (const scene::YamlEntry& entry : node.entries) out[entry.key] = to_json(entry.value);
      return out;
  }
  return out;
}

std::vector<std::string> violations(const Json& schema, const Json& value) {
  std::vector<std::string> out;
  Checker(schema).check(schema, value, "", out);
  return out;
}

}  // namespace voxtouch::test
