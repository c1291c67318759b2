// Whether the table is being changed, or has been: from pictures alone, cheaply. Hands over the table, or a
// wall on its way, are waited for. The picture's overall brightness does not count.
#pragma once

#include <chrono>
#include <optional>
#include <vector>

#include "vision/photograph.h"

namespace heliodon::vision {

struct TableWatchOptions {
    int blockPx = 12;           // pictures are compared by the means of such squares
    double blockStep = 4;       // of 255: a block that differs by more has changed
    int leastBlocks = 3;        // so many make a change
    double steadySeconds = 0.4; // without one, until the table counts as still
    double lightSeconds = 0.3; // from light on the table that changes to pictures that show it: not looked at
};

class TableWatch {
public:
    using Time = std::chrono::steady_clock::time_point;

    explicit TableWatch(const TableWatchOptions& options = {}) : options_(options) {}

    enum class State {
        same,   // as when it was last worked on
        moving, // something moves, or did a moment ago
        changed // still, and not as it was
    };
    // Cost: about a millisecond for 1392 x 1032.
    State look(const Photograph& photo, Time taken);
    // The picture that was looked at last is being worked on.
    void worked() { worked_ = last_; }
    // The projectors show something else from now on: what differs in the next pictures is that.
    void lightChanged(Time when) { lightChanged_ = when; }
    // It did so a moment before `taken`.
    bool lightIsChanging(Time taken) const;

private:
    struct Blocks {
        int across = 0, down = 0;
        std::vector<float> mean; // three a block
    };
    Blocks blocksOf(const Photograph& photo) const;
    bool differ(const Blocks& a, const Blocks& b) const;

    TableWatchOptions options_;
    std::optional<Blocks> last_, worked_;
    Time moved_{}, lightChanged_{};
    bool skipped_ = false;
};

} // namespace heliodon::vision
