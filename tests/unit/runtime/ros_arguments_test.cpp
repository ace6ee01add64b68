// ROS arguments on a program's command line: accepted, or refused by name.
#include "nodes/runtime/ros_arguments.hpp"

#include <gtest/gtest.h>

#include <CLI/CLI.hpp>

namespace voxtouch::runtime {
namespace {

using Words = std::vector<std::string>;

Words kept(const Words& words) {
  std::vector<const char*> argv{"voxtouch"};
  for (const std::string& word : words)
    argv.push_back(word.c_str());
  return without_ros_arguments(static_cast<int>(argv.size()), argv.data());
}
std::string refusal(const Words& words) {
  try {
    kept(words);
  } catch (const CLI::ValidationError& error) {
    return error.what();
  }
  return {};
}

TEST(RosArguments, ChooseTheRigByARemappingOfTheNamespace) {
  EXPECT_EQ(kept({"up", "cup", "--seed", "2"}), (Words{"up", "cup", "--seed", "2"}));
  for (const char* option : {"-r", "--remap"})
    EXPECT_EQ(kept({"--scene", "a.yaml", "--ros-args", option, "__ns:=/left"}),
              (Words{"--scene", "a.yaml", "--rig", "left"}));
  EXPECT_EQ(kept({"up", "--ros-args", "-r", "__ns:=/left", "--", "cup"}),
            (Words{"up", "--rig", "left", "cup"}));
  EXPECT_EQ(kept({"up", "cup", "--ros-args"}), (Words{"up", "cup"}));
}

TEST(RosArguments, AreRefusedByNameIfUnsupported) {
  for (const Words& asked :
       {Words{"-r", "__node:=other"}, Words{"-r", "pose:=other"},
        Words{"-p", "friction.coulomb:=0.3"}, Words{"--params-file", "a.yaml"},
        Words{"--log-level", "debug"}, Words{"-e", "/enclave"}, Words{"-r", "__ns:=left"},
        Words{"-r", "__ns:=/"}, Words{"-r", "__ns:=/a/b"}, Words{"-r"}}) {
    Words words{"up", "cup", "--ros-args"};
    words.insert(words.end(), asked.begin(), asked.end());
    const std::string why = refusal(words);
    EXPECT_TRUE(why.contains(asked.size() > 1 && asked[0] == "-r" ? asked[1] : asked[0]) ||
                asked.size() == 1)
        << why;
    EXPECT_TRUE(why.contains("not supported")) << why;
  }
}

}  // namespace
}  // namespace voxtouch::runtime
