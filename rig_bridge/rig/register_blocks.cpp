#include "rig_bridge/rig/register_blocks.hpp"

#include <algorithm>

namespace rig {

std::vector<Block> blocks_of(std::span<const Field> fields, std::uint16_t max) {
    std::vector<Block> parts;
    parts.reserve(fields.size());
    for (const Field& field : fields) parts.push_back({field.address, width(field.type)});
    std::sort(parts.begin(), parts.end(), [](const Block& a, const Block& b) { return a.address < b.address; });
    std::vector<Block> blocks;
    for (const Block& part : parts) {
        if (!blocks.empty() && blocks.back().address + blocks.back().count == part.address && blocks.back().count + part.count <= max) {
            blocks.back().count = static_cast<std::uint16_t>(blocks.back().count + part.count);
        } else {
            blocks.push_back(part);
        }
    }
    return blocks;
}

}  // namespace rig
