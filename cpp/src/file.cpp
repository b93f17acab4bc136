// Compiled once: scenes and runs as files.
#include "exported.hpp"

#include "rbdyn/file/described.ipp"
#include "rbdyn/file/disk.ipp"
#include "rbdyn/file/functions.ipp"
#include "rbdyn/file/place.ipp"
#include "rbdyn/file/scene_file.ipp"
