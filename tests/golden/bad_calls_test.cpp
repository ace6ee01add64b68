/// Calls that cannot be answered: a status that is not 0, a sentence on standard error, nothing on
/// standard output.
#include <gtest/gtest.h>

#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "tests/golden/golden.hpp"

namespace voxtouch::test {
namespace bad_calls_test {

const std::string kScene = (kData / "scenes/sphere__cylinder__exact.yaml").string();
const std::string kPoses = (kVectors / "poses/sphere__cylinder__exact.csv").string();
const std::string kMesh = (kVectors / "meshes/sphere.obj").string();

/// `says`: part of the sentence that identifies the wrong argument.
void expect_refused(const std::vector<std::string>& arguments, const std::string& says) {
  const Finished run = voxtouch(arguments);
  std::string call;
  for (const std::string& argument : arguments)
    call += " " + argument;
  SCOPED_TRACE("voxtouch" + call + "\n" + run.err);
  EXPECT_NE(run.status, 0);
  EXPECT_LT(run.status, 128) << "a signal ended it";
  EXPECT_EQ(run.out, "");
  EXPECT_NE(run.err.find(says), std::string::npos) << "expected: " << says;
  EXPECT_EQ(run.err.find("terminate called"), std::string::npos);
}

class BadCall : public testing::Test {
 protected:
  std::string file(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return (folder_ / name).string();
  }
  std::string poses(const std::string& row) const {
    return file("poses.csv", "qw,qx,qy,qz,tx,ty,tz\n" + row + "\n");
  }

  TemporaryFolder folder_;
};

TEST_F(BadCall, OfNoVerbOrAnUnknownOne) {
  expect_refused({}, "subcommand");
  expect_refused({"sing"}, "Unknown verb 'sing'");
  expect_refused({"upp", "cup"}, "Unknown verb 'upp'; did you mean 'up'?");
}

TEST_F(BadCall, WithARenamedOptionNamesTheNewOne) {
  expect_refused({"design", "--held"}, "--held; its name is --gripped");
  expect_refused({"up", "cup", "--let-go-at=2"}, "--let-go-at; its name is --release-time");
  expect_refused({"design", "--damping-floor", "0"},
                 "--damping-floor; its name is --min-damping-ratio");
  expect_refused({"report", "bag", "--beside", "bag"}, "--beside; its name is --compare-with");
}

TEST_F(BadCall, WithANameOf300LettersIsReported) {
  const std::string name(300, 'a'), said = std::string(64, 'a');
  for (const char* verb : {"up", "view", "plan", "accuracy", "report", "replay"})
    expect_refused({verb, name}, said);
  expect_refused({"new", kMesh, "--out", name}, "File name too long");
  expect_refused({"probe", kScene, "--poses", name}, "File name too long");
  expect_refused({"view", name + "/x.yaml"}, said);
}

TEST_F(BadCall, InAnInaccessibleFolderIsReported) {
  const std::filesystem::path closed = folder_ / "closed";
  std::filesystem::create_directories(closed / "in");
  std::filesystem::permissions(closed, std::filesystem::perms::none);
  if (access((closed / "in").c_str(), F_OK) == 0)
    GTEST_SKIP() << "root enters every folder";
  for (const char* verb : {"up", "view", "plan", "report", "replay"})
    expect_refused({verb, (closed / "in/x").string()}, "in/x");
  expect_refused({"new", kMesh, "--out", (closed / "in/x.yaml").string()}, "Permission denied");
  expect_refused({"probe", kScene, "--poses", (closed / "in/x.csv").string()}, "Permission denied");
  std::filesystem::permissions(closed, std::filesystem::perms::owner_all);
}

TEST_F(BadCall, OfProbeWithoutItsFiles) {
  expect_refused({"probe", "no_such.yaml", "--poses", kPoses}, "no_such.yaml");
  expect_refused({"probe", kScene, "--poses", "no_such.csv"}, "no_such.csv");
  expect_refused({"probe", kScene}, "--poses");
  expect_refused({"probe", kScene, "--poses", folder_.path().string()}, folder_.path().string());
  expect_refused({"probe", kMesh, "--poses", kPoses}, "sphere.obj");
  expect_refused({"probe", kScene, "--poses", kPoses, "--no-such"}, "--no-such");
}

TEST_F(BadCall, OfProbeWithAnUnknownModel) {
  expect_refused({"probe", kScene, "--poses", kPoses, "--model", "best"}, "--model: best");
  expect_refused({"probe", kScene, "--poses", kPoses, "--model", "Field"}, "--model: Field");
}

TEST_F(BadCall, OfProbeWithInvalidPoses) {
  for (const char* row :
       {"nan,0,0,0,0,0,0", "1,0,0,0,0,0,nan", "1,0,0,0,inf,0,0", "1,0,0,0,1e999,0,0",
        "0,0,0,0,0,0,0", "1e-4,0,0,0,0,0,0", "1e4,0,0,0,0,0,0", "1,0,0,0,0,0", "1,0,0,0,0,0,one",
        "1,0,0,0,0,0,0x1p3", "1,0,0,0,0,0,1;2"})
    expect_refused({"probe", kScene, "--poses", poses(row)}, "poses.csv:2");
  for (const char* model : {"original", "reference"})
    expect_refused(
        {"probe", kScene, "--model", model, "--poses", poses("1,0,0,0,0,0,0\nnan,0,0,0,0,0,0")},
        "poses.csv:3");
  expect_refused({"probe", kScene, "--poses", file("empty.csv", "")}, "empty.csv");
  expect_refused({"probe", kScene, "--poses", file("other.csv", "x,y,z\n1,2,3\n")}, "'qw'");
}

TEST_F(BadCall, ProbeFarOutsideTheGridFindsNoContact) {
  const Finished run =
      voxtouch({"probe", kScene, "--poses", poses("1,0,0,0,1e300,0,0\n1,0,0,0,-1e12,1e12,0")});
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.out, "nS,nI,coh,fx,fy,fz,tx,ty,tz\n0,0,0,0,0,0,0,0,0\n0,0,0,0,0,0,0,0,0\n");
}

TEST_F(BadCall, OfBuild) {
  const std::string out = (folder_ / "out").string();
  expect_refused({"build", "no_such.obj", "--voxel", "0.1", "--out", out}, "no_such.obj");
  expect_refused({"build", kMesh, "--out", out}, "--voxel");
  expect_refused({"build", kMesh, "--voxel", "0.1"}, "--out");
  for (const char* voxel : {"0", "-0.1", "one", "inf"})
    expect_refused({"build", kMesh, "--voxel", voxel, "--out", out}, "--voxel");
  expect_refused({"build", kMesh, "--voxel", "nan", "--out", out}, "'nan'");
  expect_refused({"build", kMesh, "--voxel", "0.1", "--scale", "-1", "--out", out}, "--scale");
  expect_refused({"build", kMesh, "--voxel", "0.1", "--origin", "0,0", "--out", out}, "--origin");
  expect_refused({"build", kMesh, "--voxel", "0.1", "--origin", "nan,0,0", "--out", out}, "origin");
  expect_refused({"build", file("mesh.xyz", "0 0 0\n"), "--voxel", "0.1", "--out", out}, "xyz");
  expect_refused({"build", file("empty.obj", ""), "--voxel", "0.1", "--out", out}, "empty.obj");
  expect_refused({"build", kMesh, "--voxel", "0.1", "--out", file("is_a_file", "")}, "is_a_file");
  EXPECT_FALSE(std::filesystem::exists(out)) << "a call that was refused leaves nothing behind";
}

TEST(Environment, WithAFaultyDomainOnlyStopsWhatJoinsOne) {
  for (const char* const domain : {"abc", "-1", "233", "7 "}) {
    const std::string set = std::string("ROS_DOMAIN_ID='") + domain + "' ";
    EXPECT_EQ(shell(set + "$VOXTOUCH schema").status, 0) << domain;
    EXPECT_EQ(shell(set + "$VOXTOUCH up --help").status, 0) << domain;
    const Finished status = shell(set + "$VOXTOUCH status");
    EXPECT_EQ(status.status, 1) << domain;
    EXPECT_TRUE(status.err.contains(std::string("ROS_DOMAIN_ID is '") + domain + "'"))
        << status.err;
    EXPECT_FALSE(shell(set + "$VOXTOUCH status --domain 59").err.contains("ROS_DOMAIN_ID"))
        << "an option overrides the environment";
  }
}

/// The sentence includes DDS's message and the setting to change.
TEST(Environment, OfDdsThatDoesNotStartNamesTheCause) {
  struct Case {
    const char* configuration;
    const char* cause;
  };
  for (const auto& [configuration, cause] :
       {Case{"<CycloneDDS><Domain><Nonsense>1</Nonsense></Domain></CycloneDDS>",
             "correct CYCLONEDDS_URI"},
        Case{"<CycloneDDS><Domain><Internal><SocketReceiveBufferSize min=\"1 "
             "GiB\"/></Internal></Domain></CycloneDDS>",
             "rmem_max"},
        Case{"<CycloneDDS><Domain><General><Interfaces><NetworkInterface "
             "name=\"none7\"/></Interfaces></General></Domain></CycloneDDS>",
             "none7"},
        Case{"<CycloneDDS><Domain><SharedMemory><Enable>true</Enable></SharedMemory></Domain></"
             "CycloneDDS>",
             "SharedMemory"},
        Case{"<CycloneDDS><Domain>", "CYCLONEDDS_URI is incomplete"},
        Case{"<CycloneDDS><Domain></Domain></CycloneDDS", "CYCLONEDDS_URI is incomplete"}}) {
    const Finished run = shell(std::string("CYCLONEDDS_URI='") + configuration +
                               "' timeout 20 $VOXTOUCH status --domain 59");
    EXPECT_EQ(run.status, 1) << run.err;
    const std::string last = run.err.substr(run.err.rfind('\n', run.err.size() - 2) + 1);
    EXPECT_TRUE(last.contains(cause)) << run.err;
  }
}

TEST(DefaultBag, DiffersByRigDomainAndSecond) {
  const TemporaryFolder folder;
  const std::string run =
      "XDG_DATA_HOME=" + folder.path().string() +
      " $VOXTOUCH up plane --lockstep --one-process --duration 0.05 --no-report";
  // Together, and in the shortest possible sequence.
  EXPECT_EQ(shell(run + " --domain 59 & first=$!; " + run +
                  " --domain 60 --rig other && wait $first && " + run + " --domain 59")
                .status,
            0);
  std::size_t bags = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "voxtouch/recordings"))
    bags += std::filesystem::exists(entry.path() / "metadata.yaml") ? 1U : 0U;
  EXPECT_EQ(bags, 3U);
}

TEST(Watch, EndsWhenItsReaderGoes) {
  const Finished run =
      shell("timeout 20 sh -c '$VOXTOUCH status --watch --domain 59; echo $? >&2' | head -n 1");
  EXPECT_TRUE(run.err.ends_with("1\n")) << run.err;
}

}  // namespace bad_calls_test
}  // namespace voxtouch::test
