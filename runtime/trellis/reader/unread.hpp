// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

#include <trellis/reader/formats.hpp>

namespace trellis {

// Formats that Trellis recognises and does not read: a message says what a file is, and what is read instead.

/// Returns a sentence about a file by its first bytes, "" where they are of no known binary format: images, archives,
/// meshes. \param begin  at least the first 16 bytes, where the file has as many
std::string unread_bytes(std::string_view begin);
/// Returns a sentence about an XML text with another root element than those that are read, "" of others: URDF, SDF,
/// ...
std::string unread_xml(const SourceText& text);
/// Returns what an XML file is by the name of its root element, "" of others: "an SDF file, a world or a model of
/// Gazebo".
std::string known_xml(std::string_view root);
/// Returns a sentence about another text, "" where it is of no known format: scenes of MoveIt, glTF, ...
std::string unread_text(const SourceText& text);
/// Returns a sentence about a file by the ending of its name, "" where it is of no known format.
std::string unread_ending(const std::string& path);

}  // namespace trellis
