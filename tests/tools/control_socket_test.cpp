#include "tools/command/control_socket.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>

#include "firmware/daemon/daemon_params.hpp"
#include "tests/support/temporary_folder.hpp"

namespace odoless {
namespace {

const std::string kBuiltIn = ControlParams{}.socket;

class ControlSocket : public ::testing::Test {
 protected:
  void SetUp() override { ::setenv("XDG_RUNTIME_DIR", folder_.path().c_str(), 1); }
  void TearDown() override { ::unsetenv("XDG_RUNTIME_DIR"); }
  [[nodiscard]] std::string own() const { return (folder_.path() / "odoless" / "control").string(); }

  test::TemporaryFolder folder_;
};

TEST_F(ControlSocket, IsWhereItIsConfigured) {
  EXPECT_EQ(socket_to_open("/tmp/some"), "/tmp/some");
  EXPECT_EQ(socket_to_ask("/tmp/some"), "/tmp/some");
  EXPECT_EQ(socket_to_open(""), "") << "none is wanted";
  std::filesystem::create_directory(folder_.path() / "odoless");
  static_cast<void>(folder_.file("odoless/control", ""));
  EXPECT_EQ(socket_to_ask("/tmp/some"), "/tmp/some");
}

TEST_F(ControlSocket, IsAnOrdinaryUsersOwnWhereTheSystemsFolderIsNotHis) {
  const bool may_write = ::geteuid() == 0 || ::access("/run/odoless", W_OK) == 0;
  EXPECT_EQ(socket_to_open(kBuiltIn), may_write ? kBuiltIn : own());
  ::unsetenv("XDG_RUNTIME_DIR");
  EXPECT_EQ(socket_to_open(kBuiltIn), kBuiltIn);
}

TEST_F(ControlSocket, IsAskedForAtTheUsersOwnPlaceFirst) {
  EXPECT_EQ(socket_to_ask(kBuiltIn), kBuiltIn);
  std::filesystem::create_directory(folder_.path() / "odoless");
  static_cast<void>(folder_.file("odoless/control", ""));
  EXPECT_EQ(socket_to_ask(kBuiltIn), own());
}

}  // namespace
}  // namespace odoless
