// Definitions of rbdyn/file/disk.hpp.
#pragma once

#include "rbdyn/file/disk.hpp"

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <system_error>

#if defined(__unix__) || defined(__APPLE__)
#include <sys/stat.h>
#include <unistd.h>
#endif

#include "rbdyn/basics/error.hpp"

namespace rbdyn::inline RBDYN_FORM::file {

namespace disk {

/// What a path names once its symbolic links are followed, also where there is nothing yet.
RBDYN_INLINE std::filesystem::path followed(std::filesystem::path at, std::error_code& problem) {
    // as many as Linux follows
    constexpr int most = 40;
    for (int i = 0; i < most; ++i) {
        if (!std::filesystem::is_symlink(std::filesystem::symlink_status(at, problem))) {
            // that there is nothing yet is no problem
            problem.clear();
            return at;
        }
        const auto target = std::filesystem::read_symlink(at, problem);
        if (problem) return at;
        at = at.parent_path() / target;
    }
    problem = std::make_error_code(std::errc::too_many_symbolic_link_levels);
    return at;
}

/// Gives a file the mode of another and, where the system lets us, its owner.
RBDYN_INLINE void take_mode(const std::filesystem::path& file, const std::filesystem::path& from,
                            std::error_code& problem) {
#if defined(__unix__) || defined(__APPLE__)
    // the owner first: giving a file away clears bits of its mode
    struct stat there = {};
    if (::stat(from.c_str(), &there) == 0 && ::chown(file.c_str(), there.st_uid, there.st_gid) != 0) errno = 0;
#endif
    const auto mode = std::filesystem::status(from, problem).permissions();
    if (!problem) std::filesystem::permissions(file, mode, problem);
}

/// Writes and closes; `out` is nothing if it could not be opened, and errno says why.
RBDYN_INLINE std::error_code put(std::FILE* out, std::string_view text) {
    const auto last = [] { return std::error_code(errno != 0 ? errno : EIO, std::generic_category()); };
    if (out == nullptr) return last();
    errno = 0;
    const bool is_written = text.empty() || std::fwrite(text.data(), 1, text.size(), out) == text.size();
    const std::error_code problem = is_written ? std::error_code() : last();
    errno = 0;
    // what was buffered is refused here
    return std::fclose(out) == 0 || problem ? problem : last();
}

/// A file of a new name beside `place`, open to be written.
RBDYN_INLINE std::FILE* open_beside(const std::filesystem::path& place, std::filesystem::path& name) {
    // others may write the same place, or have left what they began
    constexpr int most = 1000;
    for (int i = 0; i < most; ++i) {
        name = place;
        name += i == 0 ? ".part" : ".part" + std::to_string(i);
        errno = 0;
        std::FILE* const out = std::fopen(name.string().c_str(), "wbx");
        if (out != nullptr || errno != EEXIST) return out;
    }
    return nullptr;
}

}  // namespace disk

RBDYN_INLINE std::string read_file(const std::string& path) {
    std::error_code problem;
    const auto kind = std::filesystem::status(path, problem);
    if (!std::filesystem::exists(kind)) throw InvalidInput("load: there is no file \"" + path + "\"");
    if (std::filesystem::is_directory(kind)) throw InvalidInput("load: \"" + path + "\" is a folder; give a file");
    std::ifstream in(path, std::ios::binary);
    std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    if (!in) throw InvalidInput("load: \"" + path + "\" cannot be read");
    return text;
}

RBDYN_INLINE std::string trouble_writing(const std::string& path, std::string_view text) {
    namespace fs = std::filesystem;
    if (path.empty()) return "a path has characters";
    std::error_code problem;
    const auto kind = fs::status(path, problem);
    if (fs::is_directory(kind)) return "it is a folder; give a file";
    const fs::path place = disk::followed(path, problem);
    if (problem) return problem.message();
    const bool is_there = fs::exists(kind);
    // links of a process to what it has open lead by no path to what is a pipe or was removed
    if (is_there && (!fs::is_regular_file(kind) || !fs::equivalent(place, path, problem))) {
        errno = 0;
        problem = disk::put(std::fopen(path.c_str(), "wb"), text);
        return problem ? problem.message() : "";
    }
    // whole or not at all: what was there stays until all of it is written
    fs::path part;
    std::FILE* const out = disk::open_beside(place, part);
    if (out == nullptr) return disk::put(out, text).message();
    // before anything is in it that others may not read
    if (is_there) disk::take_mode(part, place, problem);
    if (const std::error_code failed = disk::put(out, text); failed) problem = failed;
    if (!problem) fs::rename(part, place, problem);
    if (!problem) return "";
    std::error_code ignored;
    fs::remove(part, ignored);
    return problem.message();
}

RBDYN_INLINE void write_file(const std::string& path, std::string_view text) {
    const std::string trouble = trouble_writing(path, text);
    if (!trouble.empty()) throw InvalidInput("save: \"" + path + "\" cannot be written: " + trouble);
}

}  // namespace rbdyn::inline RBDYN_FORM::file
