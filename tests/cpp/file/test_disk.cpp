// What a file is written over: links, modes, pipes and devices stay what they are.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "rbdyn/file/disk.hpp"
#include "refusal.hpp"

namespace rbdyn::test::test_disk {
namespace {

namespace fs = std::filesystem;

class Disk : public testing::Test {
protected:
    Disk() { fs::create_directory(folder); }
    ~Disk() override { fs::remove_all(folder); }

    std::string at(const std::string& name) const { return (folder / name).string(); }
    std::string content(const std::string& name) const {
        std::ifstream in(folder / name);
        return {std::istreambuf_iterator<char>(in), {}};
    }
    std::string refused(const std::string& path) const {
        return refusal([&] { file::write_file(path, "new"); });
    }

    const fs::path folder = fs::temp_directory_path() / ("rbdyn_test_disk_" + std::to_string(::getpid()));
};

TEST_F(Disk, a_symbolic_link_goes_on_naming_what_is_written) {
    fs::create_directory(folder / "below");
    std::ofstream(at("below/there")) << "old";
    fs::create_symlink("below/there", at("relative"));
    fs::create_symlink(at("relative"), at("link_to_link"));
    fs::create_symlink("below/not_yet", at("dangling"));
    for (const char* name : {"relative", "link_to_link", "dangling"}) {
        file::write_file(at(name), name);
        EXPECT_TRUE(fs::is_symlink(at(name))) << name;
        EXPECT_EQ(content(name), name);
    }
    EXPECT_EQ(content("below/there"), "link_to_link");
    EXPECT_EQ(content("below/not_yet"), "dangling");
    fs::create_symlink("round", at("round"));
    EXPECT_NE(refused(at("round")).find("symbolic links"), std::string::npos);
    // nothing is left beside
    EXPECT_EQ(std::distance(fs::directory_iterator(folder / "below"), {}), 2);
}

TEST_F(Disk, a_file_keeps_its_mode_and_what_lies_beside_it) {
    using fs::perms;
    std::ofstream(at("own")) << "old";
    std::ofstream(at("own.part")) << "another's";
    for (const perms mode : {perms::owner_read | perms::owner_write, perms::owner_all | perms::group_read}) {
        fs::permissions(at("own"), mode);
        file::write_file(at("own"), "new");
        EXPECT_EQ(fs::status(at("own")).permissions(), mode);
    }
    EXPECT_EQ(content("own"), "new");
    EXPECT_EQ(content("own.part"), "another's");
}

TEST_F(Disk, a_pipe_is_written_into) {
    ASSERT_EQ(::mkfifo(at("pipe").c_str(), 0600), 0);
    const int reader = ::open(at("pipe").c_str(), O_RDONLY | O_NONBLOCK);
    ASSERT_GE(reader, 0);
    file::write_file(at("pipe"), "into it");
    std::array<char, 16> read{};
    EXPECT_EQ(::read(reader, read.data(), read.size()), 7);
    EXPECT_EQ(std::string(read.data()), "into it");
    ::close(reader);
    EXPECT_TRUE(fs::is_fifo(at("pipe")));
}

TEST_F(Disk, what_a_device_refuses_is_an_error) {
    // to one who may replace files of the system, a device of the test's own
    if (::geteuid() != 0)
        fs::create_symlink("/dev/full", at("full"));
    else if (::mknod(at("full").c_str(), S_IFCHR | 0600, ::makedev(1, 7)) != 0)
        GTEST_SKIP() << "no device can be made here";
    EXPECT_NE(refused(at("full")).find("cannot be written: No space left"), std::string::npos) << refused(at("full"));
    EXPECT_TRUE(fs::is_character_file(at("full")));
}

TEST_F(Disk, what_is_no_place_for_a_file_is_refused) {
    EXPECT_NE(refused(at("")).find("it is a folder; give a file"), std::string::npos);
    EXPECT_NE(refused("").find("a path has characters"), std::string::npos);
    EXPECT_NE(refused(at("none/x")).find("No such file"), std::string::npos);
}

}  // namespace
}  // namespace rbdyn::test::test_disk
