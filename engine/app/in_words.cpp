#include "engine/app/in_words.h"

#include <fmt/format.h>

namespace heliodon::app {

std::string inWords(const geometry::Sketch& sketch) {
    const std::string arcs = sketch.arcs.empty() ? "" : ", " + counted(sketch.arcs.size(), "arc");
    return fmt::format("{}{}, {}, {}, {}{}", counted(sketch.walls.size(), "wall"), arcs,
                       counted(sketch.windows.size(), "window"), counted(sketch.skylights.size(), "skylight"),
                       counted(sketch.tokens.size(), "token"), sketch.north ? ", north" : ", no north arrow");
}

} // namespace heliodon::app
