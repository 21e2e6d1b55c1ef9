// Atomic replacement of files by renaming, and targets that must not be replaced.
#include "shared/host/file.h"

#include <gmock/gmock.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <thread>

#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"
#include "tests/support/user_error_of.h"

namespace bess {
namespace {

namespace fs = std::filesystem;

class File : public testing::Test {
 protected:
  TemporaryFolder folder_;
  fs::path path_ = folder_.file("out.txt");
};

TEST_F(File, ReplacesAFileAndKeepsItsPermissions) {
  write_file(path_, "first");
  fs::permissions(path_, fs::perms::owner_read | fs::perms::owner_write);
  write_file(path_, "second");
  EXPECT_EQ(read_file(path_), "second");
  EXPECT_EQ(fs::status(path_).permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

TEST_F(File, ALinkStaysAndItsTargetIsReplaced) {
  const fs::path link = folder_.file("link.txt");
  write_file(path_, "first");
  fs::create_symlink(path_, link);
  write_file(link, "second");
  EXPECT_TRUE(fs::is_symlink(link));
  EXPECT_EQ(read_file(path_), "second");
}

TEST_F(File, APipeIsWrittenToAndStays) {
  ASSERT_EQ(mkfifo(path_.c_str(), 0600), 0);
  std::string received;
  std::thread reader([&] {
    std::ifstream pipe(path_);
    std::getline(pipe, received);
  });
  require_writable(path_);
  write_file(path_, "through\n");
  reader.join();
  EXPECT_EQ(received, "through");
  EXPECT_TRUE(fs::is_fifo(path_));
}

TEST_F(File, AFullDeviceIsAnErrorAndStaysADevice) {
  const fs::path full = "/dev/full";
  if (!fs::is_character_file(full)) GTEST_SKIP() << "needs /dev/full, which is absent";
  EXPECT_THROW(write_file(full, "text"), UserError);
  EXPECT_TRUE(fs::is_character_file(full));
}

/// Another user's link in place of the temporary file must not redirect the text.
TEST_F(File, APlantedLinkIsNotFollowed) {
  const std::string victim = folder_.write("victim", "precious");
  fs::create_symlink(victim, path_.string() + ".part." + std::to_string(getpid()));
  write_file(path_, "text");
  EXPECT_EQ(read_file(victim), "precious");
  EXPECT_EQ(read_file(path_), "text");
  EXPECT_FALSE(fs::is_symlink(path_));
}

std::string complaint_about(const fs::path& path, std::size_t bytes_max = kFileBytesMax) {
  return refusal_of([&] { return read_file(path, bytes_max); });
}

std::string packed(const TemporaryFolder& folder, const std::string& text) {
  write_file(folder.file("packed.gz"), text);
  return text_of_file(folder.file("packed.gz"));
}

TEST_F(File, GzipIsReadByItsContentInOneMemberOrMore) {
  const std::string one = packed(folder_, "one\n");
  const std::string two = packed(folder_, std::string(3'000'000, 'x') + "\n");
  EXPECT_EQ(read_file(folder_.write("a", one + two + one)),
            "one\n" + std::string(3'000'000, 'x') + "\none\n");
  for (const char* text : {"", "\x1F", "x", "\x1Fx"}) {
    EXPECT_EQ(read_file(folder_.write("short", text)), text);
  }
}

TEST_F(File, TrailingOrMissingGzipDataIsReported) {
  const std::string whole = packed(folder_, "minutes of a day, and some more of them\n");
  for (const std::string& rest :
       {std::string("x"), std::string("2023-01-01T00:00:00Z,1,2\n"), std::string(512, '\0')}) {
    EXPECT_THAT(complaint_about(folder_.write("a.gz", whole + rest)), Names("a.gz"));
  }
  EXPECT_THAT(complaint_about(folder_.write("b.gz", whole + "\x1F")), Names("b.gz"));
  for (std::size_t cut = 2; cut < whole.size(); ++cut) {
    EXPECT_THAT(complaint_about(folder_.write("c.gz", whole.substr(0, cut))), Names("c.gz")) << cut;
  }
  const std::string text = read_file(folder_.write("d", whole));
  std::size_t told = 0;
  for (std::size_t at = 10; at < whole.size(); ++at) {  // data, CRC, size
    std::string flipped = whole;
    flipped[at] = static_cast<char>(flipped[at] ^ 0x40);
    const std::string path = folder_.write("d", flipped);
    const std::string complaint = complaint_about(path);
    if (complaint.empty()) {
      EXPECT_EQ(read_file(path), text) << "a bit that means nothing: " << at;
    } else {
      EXPECT_THAT(complaint, Names(path)) << at;
      ++told;
    }
  }
  EXPECT_GE(told, whole.size() - 12);
}

/// 1.2 MB instead of 1.2 GB: memory never exceeds the bound.
TEST_F(File, ABombIsBoundedWhileItIsRead) {
  std::string comments;
  while (comments.size() < 1'000'000) comments += "# nothing\n";
  const std::string member = packed(folder_, comments);
  std::string bomb;
  for (int i = 0; i < 1'200; ++i) bomb += member;
  EXPECT_THAT(complaint_about(folder_.write("bomb.gz", bomb), 16 << 20), Names("bomb.gz 16 MiB"));
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  EXPECT_LT(usage.ru_maxrss, 300'000) << "kilobytes";
  EXPECT_EQ(complaint_about(folder_.write("member.gz", member), comments.size()), "");
  EXPECT_THAT(complaint_about(folder_.write("member.gz", member), comments.size() - 1),
              Names("member.gz"));
}

TEST_F(File, ADeviceWithoutEndEnds) {
  EXPECT_THAT(complaint_about("/dev/zero", 1 << 20), Names("/dev/zero 1 MiB"));
}

TEST_F(File, LinksInALoopAndNamesTooLongAreOneLine) {
  fs::create_symlink(folder_.file("two"), folder_.file("one"));
  fs::create_symlink(folder_.file("one"), folder_.file("two"));
  EXPECT_THAT(complaint_about(folder_.file("one")), Names(folder_.file("one")));
  EXPECT_THAT(complaint_about(folder_.file(std::string(300, 'a'))), Names(std::string(300, 'a')));
  EXPECT_THROW(write_file(folder_.file("one"), "text"), UserError);
  EXPECT_THROW(require_writable(folder_.file(std::string(300, 'a'))), UserError);
  EXPECT_TRUE(fs::is_symlink(fs::symlink_status(folder_.file("one"))));
}

TEST_F(File, WhatAKilledProcessLeftIsRemoved) {
  std::ofstream(path_.string() + ".part.999999999") << "partial";
  write_file(path_, "whole");
  EXPECT_FALSE(fs::exists(path_.string() + ".part.999999999"));
}

}  // namespace
}  // namespace bess
