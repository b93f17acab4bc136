// Gives every input of the corpus to its target again, without a fuzzer: replay CORPUS [TARGET].
#include <cctype>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "target.hpp"

namespace {

/// What pairs of hexadecimal digits stand for; all else between them is left out.
std::string from_hex(const std::string& text) {
    std::string bytes, pair;
    for (const char c : text) {
        if (std::isxdigit(static_cast<unsigned char>(c)) == 0) continue;
        pair += c;
        if (pair.size() < 2) continue;
        bytes += static_cast<char>(std::stoi(pair, nullptr, 16));
        pair.clear();
    }
    return bytes;
}

}  // namespace

int main(int count, char** words) {
    namespace fs = std::filesystem;
    int given = 0, finds = 0;
    for (const rbdyn::fuzz::Target& target : rbdyn::fuzz::targets) {
        if (count < 2 || (count > 2 && target.name != words[2])) continue;
        for (const auto& entry : fs::directory_iterator(fs::path(words[1]) / target.name)) {
            std::ifstream file(entry.path(), std::ios::binary);
            const std::string text{std::istreambuf_iterator<char>(file), {}};
            ++given;
            try {
                rbdyn::fuzz::give(target, target.is_text ? text : from_hex(text));
            } catch (const std::exception& e) {
                ++finds;
                std::printf("%s: %s\n", entry.path().c_str(), e.what());
            }
        }
    }
    std::printf("%d inputs, %d finds\n", given, finds);
    return given > 0 && finds == 0 ? 0 : 1;
}
