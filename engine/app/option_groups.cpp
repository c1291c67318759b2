#include "engine/app/option_groups.h"

#include "engine/app/option_checks.h"

namespace heliodon::app {

void addScene(CLI::App* sub, SceneArguments& scene) {
    sub->add_option("INPUT", scene.input,
                    "photograph (.png .jpg .tif), sketch (.json) or model (.obj .gltf .glb)")
        ->required();
    sub->add_option("--rig", scene.rig, "calibrated camera and projectors (.json); a photograph needs it");
    addMesh(sub, scene);
    sub->add_option("--up", scene.up, "up axis of a model: y or z (default y)")
        ->check(CLI::IsMember({"y", "z"}));
    sub->add_option("--model-scale", scene.modelScale,
                    "how many times larger than a model (.obj .gltf .glb) its building is (default 12 for "
                    "models under 1 m high, as on the table, else 1)")
        ->check(within(1e-6, 1e6));
    sub->add_option(
           "--glass", scene.glass,
           "MATERIAL=T or MATERIAL=R,G,B of a model: it is glass of that visible transmittance at normal "
           "incidence, whatever the file says; may be given several times")
        ->allow_extra_args(false);
    sub->add_option("--reflectance", scene.reflectance,
                    "of materials that a model names and does not define (a missing .mtl), and the brightest "
                    "channel of those that it states as 1 or more, as no paint is")
        ->check(within(0, 0.99));
    sub->add_option(
           "--leave-out", scene.leftOut,
           "NAME of an object, group, node, mesh or material of a model: its faces are taken as not in "
           "the file; may be given several times")
        ->allow_extra_args(false);
}

void addMesh(CLI::App* sub, SceneArguments& scene) {
    sub->add_option("--triangles", scene.triangles, "patches aimed at (default 2000)")
        ->check(within(4, 2000000));
    sub->add_option(
           "--chord-error", scene.chordError,
           "how far facets of curved walls may lie off the arc, in inches on the table (default 0.02, "
           "more where so many facets would exceed --triangles)")
        ->check(within(0.001, 0.5));
    sub->add_option("--north", scene.northDeg, "turn north by so many degrees, clockwise seen from above")
        ->check(within(-360, 360));
}

void addBlinds(CLI::App* sub, SceneArguments& scene) {
    sub->add_option("--blinds", scene.blinds,
                    "[MATERIAL=]STATE of windows: open, fabric:T[,R] (diffuse transmittance, reflectance) "
                    "or slats:ANGLE[,R[,SPACING]] (degrees, outer edges down; reflectance 0.7; spacing over "
                    "width 0.8); may be given several times")
        ->allow_extra_args(false);
}

void addMoment(CLI::App* sub, MomentArguments& moment, bool withTime) {
    sub->add_option("--site", moment.site,
                    "LAT,LON in degrees north and east (default: the rig's, else 42.73,-73.68)");
    if (withTime)
        sub->add_option("--time", moment.time,
                        "2026-03-21T13:00-05:00, or ...T13:00solar for apparent solar time (default 21 "
                        "March 13:00 solar)");
    sub->add_option(
        "--sky", moment.sky,
        "clear, overcast, intermediate, cie:1..15, perez:DNI,DHI in W/m2, or a sky file (default clear)");
}

void addWeather(CLI::App* sub, MomentArguments& moment) {
    sub->add_option("--weather", moment.weather,
                    "hourly weather (.epw, .wea, also .gz) in place of a sky; its site is used")
        ->excludes("--sky");
}

void addGround(CLI::App* sub, MomentArguments& moment) {
    sub->add_option("--ground", moment.groundAlbedo,
                    "diffuse reflectance of the ground outside (default 0.2); goes before a sky file's")
        ->check(within(0.0, 1.0));
}

void addScatter(CLI::App* sub, PictureArguments& picture) {
    sub->add_flag("--compensate-scatter", picture.compensateScatter,
                  "leave out of projectors' pictures what the model's own surfaces throw at one another "
                  "(their reflectance: surface_reflectance of the rig, default 0.84)")
        ->needs("--rig");
}

void addPicture(CLI::App* sub, PictureArguments& picture, const std::string& sizeHelp) {
    sub->add_option("--exposure", picture.exposure,
                    "lux of exitance that shows as white (default: chosen from the picture)")
        ->check(positive());
    sub->add_flag("--false-color", picture.falseColor,
                  "lux as colours, with a legend; one scale for a whole film or contact sheet");
    sub->add_flag("--sky-color", picture.skyColour,
                  "light in the colours of sun and sky, not white; lux stay as they are");
    addScatter(sub, picture);
    sub->add_option("--size", picture.size, sizeHelp);
    sub->add_flag("--exr", picture.exr,
                  "OpenEXR too, 32-bit float: previews hold exitance in lux per channel, projectors' "
                  "pictures their drive, linear, 1 = full");
}

CLI::Option* addRadiosityError(CLI::App* sub, double& value) {
    return sub
        ->add_option(
            "--max-radiosity-error", value,
            "wanted error of radiosity over its largest value, from form factors and solution, for the "
            "reflectances of this model; picks kernel and row error")
        ->check(within(1e-6, 1.0));
}

} // namespace heliodon::app
