# Print an optspec for argparse to handle cmd's options that are independent of any subcommand.
function __fish_etendue_global_optspecs
    string join \n h/help V/version
end

function __fish_etendue_needs_command
    # Figure out if the current invocation already has a command.
    set -l cmd (commandline -opc)
    set -e cmd[1]
    argparse -s (__fish_etendue_global_optspecs) -- $cmd 2>/dev/null
    or return
    if set -q argv[1]
        # Also print the command, so this can be used to figure out what it is.
        echo $argv[1]
        return 1
    end
    return 0
end

function __fish_etendue_using_subcommand
    set -l cmd (__fish_etendue_needs_command)
    test -z "$cmd"
    and return 1
    contains -- $cmd[1] $argv
end

complete -c etendue -n "__fish_etendue_needs_command" -s h -l help -d 'Print help (see more with \'--help\')'
complete -c etendue -n "__fish_etendue_needs_command" -s V -l version -d 'Print version'
complete -c etendue -n "__fish_etendue_needs_command" -f -a "render" -d 'Render a scene to image files'
complete -c etendue -n "__fish_etendue_needs_command" -f -a "convert" -d 'Write any scene as a scene file of the native format, with its meshes and images beside it'
complete -c etendue -n "__fish_etendue_needs_command" -f -a "merge" -d 'Put the parts of a picture together that were rendered by several processes'
complete -c etendue -n "__fish_etendue_needs_command" -f -a "info" -d 'Say what a scene holds, what was built for it and why'
complete -c etendue -n "__fish_etendue_needs_command" -f -a "photons" -d 'Write the photons of a map, or draw them'
complete -c etendue -n "__fish_etendue_needs_command" -f -a "bake" -d 'Bake light maps: the irradiance of all surfaces, in texels and at vertices'
complete -c etendue -n "__fish_etendue_needs_command" -f -a "lux" -d 'Calculate illuminance [lx] and luminance [cd/m²] at points, with the figures of lighting design'
complete -c etendue -n "__fish_etendue_needs_command" -f -a "compare" -d 'Measure how far image A is from the reference B'
complete -c etendue -n "__fish_etendue_needs_command" -f -a "bench" -d 'Measure time and error of scenes against references, and write a report'
complete -c etendue -n "__fish_etendue_needs_command" -f -a "help" -d 'Print this message or the help of the given subcommand(s)'
complete -c etendue -n "__fish_etendue_using_subcommand render" -s o -l output -d 'Image files to write, by extension: .exr, .pfm or .png. Put them after the scene, or repeat the option' -r -F
complete -c etendue -n "__fish_etendue_using_subcommand render" -l threads -d 'Threads; 0 takes all there are' -r
complete -c etendue -n "__fish_etendue_using_subcommand render" -l camera -d 'Name or number of the camera of a glTF file, in place of the first one of its scene' -r
complete -c etendue -n "__fish_etendue_using_subcommand render" -l at -d 'Seconds after the beginning of the animation of a glTF file at which the scene is seen' -r
complete -c etendue -n "__fish_etendue_using_subcommand render" -l animation -d 'Name or number of the animation of a glTF file, in place of the first one' -r
complete -c etendue -n "__fish_etendue_using_subcommand render" -l time-at -d 'The time in seconds at which a scene in which something moves is seen, without blur, in place of its shutter' -r
complete -c etendue -n "__fish_etendue_using_subcommand render" -l frames -d 'Frames of a scene in which something moves, such as 1-48. The shutter\'s times are from the time of the frame on, which is its number over the frame rate. Each # in the names of files is a digit of the number' -r
complete -c etendue -n "__fish_etendue_using_subcommand render" -l frame-rate -d 'Frames per second' -r
complete -c etendue -n "__fish_etendue_using_subcommand render" -l spp -d 'Samples per pixel, in place of the scene\'s' -r
complete -c etendue -n "__fish_etendue_using_subcommand render" -l time -d 'Stop after so many seconds. With --spp, at whichever comes first; without, the scene\'s samples do not count' -r
complete -c etendue -n "__fish_etendue_using_subcommand render" -l target-error -d 'Stop when the estimated relMSE of the image is no larger than this, such as 0.001' -r
complete -c etendue -n "__fish_etendue_using_subcommand render" -l target-display -d 'Stop when the estimated error of what a screen shows is no larger than this, in levels of 255, such as 2' -r
complete -c etendue -n "__fish_etendue_using_subcommand render" -l adaptive -d 'More samples for pixels with more error; alone it means on. On by itself where an error is aimed at without --reuse' -r -f -a "on\t''
off\t''"
complete -c etendue -n "__fish_etendue_using_subcommand render" -l seed -d 'Seed of all randomness, in place of the scene\'s' -r
complete -c etendue -n "__fish_etendue_using_subcommand render" -l resolution -d 'Width and height in pixels, such as 640x480, in place of the scene\'s' -r
complete -c etendue -n "__fish_etendue_using_subcommand render" -l crop -d 'Renders only this rectangle of the picture: first column, first row, width and height, such as 100,50,64x48' -r
complete -c etendue -n "__fish_etendue_using_subcommand render" -l integrator -d 'Light transport, in place of the scene\'s' -r -f -a "path\t'Path tracing: all light, by paths from the camera'
whitted\t'Direct light, perfect mirrors and glass; no diffuse interreflection'
direct\t'Emission and light scattered once'
photon_direct\t'The report\'s photon map: direct light from photons, where no shadow photon is among them'
caustic\t'Path tracing, with caustics from a photon map'
photon\t'A global and a caustic photon map, with final gathering'
irradiance_cache\t'All light, with indirect diffuse light interpolated between final gathers'
radiosity\t'The diffuse scene solved as a whole, for every view of it'
ppm\t'Progressive photon mapping: a new map every pass, with one shrinking radius'
sppm\t'Stochastic progressive photon mapping: a new map every pass, with radii that shrink pixel by pixel'
auto\t'Path tracing, path tracing with a caustic map, or stochastic progressive photon mapping, by what the scene holds; the irradiance cache where a bias is allowed'"
complete -c etendue -n "__fish_etendue_using_subcommand render" -l reuse -d 'Pixels in groups of 16 share the second hits of their paths; alone it means on. Only with the integrator path. In place of the choice of the scene; by default, a pilot of long renders says' -r -f -a "on\t''
off\t''"
complete -c etendue -n "__fish_etendue_using_subcommand render" -l light-paths -d 'Light paths, from lamps by way of mirrors and glass to what the camera sees, find caustics beside the paths from the camera; alone it means on. Only with the integrator path. In place of the choice of the scene; by default, a pilot of long renders says' -r -f -a "on\t''
off\t''"
complete -c etendue -n "__fish_etendue_using_subcommand render" -l bias -d 'Whether the integrator auto may choose the irradiance cache, whose bias error estimates do not know, where a pilot of a long render says that its whole error is the least for the time. In place of the scene\'s' -r -f -a "refused\t'Unbiased and consistent integrators only'
allowed\t'The irradiance cache too'"
complete -c etendue -n "__fish_etendue_using_subcommand render" -l spectral -d 'Paths carry wavelengths instead of three channels; alone it means on. In place of the scene\'s choice' -r -f -a "on\t''
off\t''"
complete -c etendue -n "__fish_etendue_using_subcommand render" -l spectral-layers -d 'Layers of an EXR for the mean spectral radiance over so many bands of equal width, 3 to 512. With --spectral' -r
complete -c etendue -n "__fish_etendue_using_subcommand render" -l spectral-range -d 'First and last wavelength of those bands in nm, within 360 and 830' -r
complete -c etendue -n "__fish_etendue_using_subcommand render" -l cryptomatte-levels -d 'Number of objects, and of materials, that a pixel keeps: those that cover most of it. Even, 2 to 64. With --cryptomatte' -r
complete -c etendue -n "__fish_etendue_using_subcommand render" -l white-balance -d 'The light under which white surfaces are grey in the picture: A, D50, D55, D65, D75, E, FL1 to FL12, a temperature in kelvin (black bodies below 4000, daylight above), or its chromaticity X,Y' -r
complete -c etendue -n "__fish_etendue_using_subcommand render" -l filter -d 'Pixel filter: box, tent, gaussian[:SIGMA], blackman-harris or mitchell[:B,C]' -r
complete -c etendue -n "__fish_etendue_using_subcommand render" -l sampler -d 'Where the samples of a pixel come from' -r -f -a "sobol\t'Owen-scrambled Sobol\' points'
random\t'Independent random numbers'
jittered\t'One random position in each of n x n cells'
grid\t'n x n regular positions'
gaussian\t'Normally distributed around the pixel\'s centre'"
complete -c etendue -n "__fish_etendue_using_subcommand render" -l shadow-rays -d 'Light samples per hit, in place of the scene\'s' -r
complete -c etendue -n "__fish_etendue_using_subcommand render" -l first-shadow-rays -d 'Light samples at the hits that the camera sees itself or by way of mirrors and smooth glass alone. Only with the integrator path. In place of the scene\'s; by default, a pilot of long renders says' -r
complete -c etendue -n "__fish_etendue_using_subcommand render" -l roulette -d 'Which survival probability Russian roulette ends paths by, in place of the scene\'s' -r -f -a "own\t'The library\'s own, by the throughput that a path still carries'
file\t'The reflectionRate of the scene\'s materials'"
complete -c etendue -n "__fish_etendue_using_subcommand render" -l photons -d 'Light paths of a photon map (of each pass, where maps are made anew), in place of the scene\'s' -r
complete -c etendue -n "__fish_etendue_using_subcommand render" -l photon-radius -d 'Radius of density estimates in scene units, in place of the scene\'s' -r
complete -c etendue -n "__fish_etendue_using_subcommand render" -l caustic-photons -d 'Light paths of a caustic map, in place of the scene\'s' -r
complete -c etendue -n "__fish_etendue_using_subcommand render" -l caustic-radius -d 'Radius of caustics in scene units, in place of the scene\'s' -r
complete -c etendue -n "__fish_etendue_using_subcommand render" -l iterations -d 'Radiosity: iterations, or none to go on until little is left. Gathered ones are bounces of light' -r
complete -c etendue -n "__fish_etendue_using_subcommand render" -l element-size -d 'Radiosity: longest side below which elements are not divided, in scene units, in place of the scene\'s' -r
complete -c etendue -n "__fish_etendue_using_subcommand render" -l radiosity-error -d 'Radiosity: what one link between elements may be wrong by, in thousandths of all irradiance' -r
complete -c etendue -n "__fish_etendue_using_subcommand render" -l radiosity-solver -d 'Radiosity: how the system is solved' -r -f -a "gather\t'Every element gathers from all others, again and again'
shoot\t'The patch that has most light left shoots it'"
complete -c etendue -n "__fish_etendue_using_subcommand render" -l ambient -d 'Radiosity: light that was not yet distributed is shown as its mean; alone it means on' -r -f -a "on\t''
off\t''"
complete -c etendue -n "__fish_etendue_using_subcommand render" -l final-gather -d 'Radiosity: direct light from light samples, indirect light from a ray into the solution; alone it means on' -r -f -a "on\t''
off\t''"
complete -c etendue -n "__fish_etendue_using_subcommand render" -l max-depth -d 'Greatest number of surface hits on a path, or none for no cut' -r
complete -c etendue -n "__fish_etendue_using_subcommand render" -l checkpoint -d 'A file for the state of the render, written every so often and at the end, also where a signal stops the render' -r -F
complete -c etendue -n "__fish_etendue_using_subcommand render" -l checkpoint-every -d 'Seconds from one checkpoint to the next' -r
complete -c etendue -n "__fish_etendue_using_subcommand render" -l resume -d 'Go on from a checkpoint of the same scene and settings. Of these, only the number of samples, time, errors and threads may differ' -r -F
complete -c etendue -n "__fish_etendue_using_subcommand render" -l share -d 'Render part K of N of the picture, such as 3/16, into a checkpoint; `merge` makes the picture of all parts' -r
complete -c etendue -n "__fish_etendue_using_subcommand render" -l stats -d 'A file for what the render came to: one JSON object' -r -F
complete -c etendue -n "__fish_etendue_using_subcommand render" -l tone-map -d 'How radiance becomes brightness in a PNG' -r -f -a "maximum\t'Divide by the largest value of the image'
clamp\t'1 is white, and so is all above'
reinhard\t'x / (1 + x)'
aces\t'A film-like curve'"
complete -c etendue -n "__fish_etendue_using_subcommand render" -l primaries -d 'Primaries of the colours of an EXR or PFM; a PNG is always sRGB' -r -f -a "rec709\t'Rec. 709, white D65'
rec2020\t'Rec. 2020, white D65'
acescg\t'ACEScg, adapted to its white'
xyz\t'Tristimulus values of CIE 1931'"
complete -c etendue -n "__fish_etendue_using_subcommand render" -l exposure -d 'Brightness of a PNG in stops: 1 doubles it' -r
complete -c etendue -n "__fish_etendue_using_subcommand render" -l light-layers -d 'Layers of an EXR for light by how often it was scattered on its way from its emitter: emission (not at all), direct (once) and indirect. With the integrators path, direct and auto, which is then path'
complete -c etendue -n "__fish_etendue_using_subcommand render" -l cryptomatte -d 'Layers of an EXR by which compositing programs pick objects and materials by name, as Cryptomatte 1.2 has them: ids with their coverage of the pixel. One more ray for each sample, after the render'
complete -c etendue -n "__fish_etendue_using_subcommand render" -l progressive -d 'Rewrite the images after each pass'
complete -c etendue -n "__fish_etendue_using_subcommand render" -s q -l quiet -d 'No progress and no summary; warnings and errors stay'
complete -c etendue -n "__fish_etendue_using_subcommand render" -s h -l help -d 'Print help (see more with \'--help\')'
complete -c etendue -n "__fish_etendue_using_subcommand convert" -l params -d 'Parameter file of a scene of the 2017 report' -r -F
complete -c etendue -n "__fish_etendue_using_subcommand convert" -l camera -d 'Name or number of the camera of a glTF file, in place of the first one of its scene' -r
complete -c etendue -n "__fish_etendue_using_subcommand convert" -l at -d 'Seconds after the beginning of the animation of a glTF file at which the scene is seen' -r
complete -c etendue -n "__fish_etendue_using_subcommand convert" -l animation -d 'Name or number of the animation of a glTF file, in place of the first one' -r
complete -c etendue -n "__fish_etendue_using_subcommand convert" -s q -l quiet -d 'No summary; warnings and errors stay'
complete -c etendue -n "__fish_etendue_using_subcommand convert" -s h -l help -d 'Print help'
complete -c etendue -n "__fish_etendue_using_subcommand merge" -s o -l output -d 'Image files to write, by extension: .exr, .pfm or .png. Put them after the checkpoints, or repeat the option' -r -F
complete -c etendue -n "__fish_etendue_using_subcommand merge" -l checkpoint -d 'A file for the checkpoint of the whole picture' -r -F
complete -c etendue -n "__fish_etendue_using_subcommand merge" -l tone-map -d 'How radiance becomes brightness in a PNG' -r -f -a "maximum\t'Divide by the largest value of the image'
clamp\t'1 is white, and so is all above'
reinhard\t'x / (1 + x)'
aces\t'A film-like curve'"
complete -c etendue -n "__fish_etendue_using_subcommand merge" -l primaries -d 'Primaries of the colours of an EXR or PFM; a PNG is always sRGB' -r -f -a "rec709\t'Rec. 709, white D65'
rec2020\t'Rec. 2020, white D65'
acescg\t'ACEScg, adapted to its white'
xyz\t'Tristimulus values of CIE 1931'"
complete -c etendue -n "__fish_etendue_using_subcommand merge" -l exposure -d 'Brightness of a PNG in stops: 1 doubles it' -r
complete -c etendue -n "__fish_etendue_using_subcommand merge" -s q -l quiet -d 'No summary; warnings and errors stay'
complete -c etendue -n "__fish_etendue_using_subcommand merge" -s h -l help -d 'Print help (see more with \'--help\')'
complete -c etendue -n "__fish_etendue_using_subcommand info" -l threads -d 'Threads to build with; 0 takes all there are' -r
complete -c etendue -n "__fish_etendue_using_subcommand info" -s h -l help -d 'Print help'
complete -c etendue -n "__fish_etendue_using_subcommand photons" -s o -l output -d 'Files to write, by extension: tables (.csv), point clouds (.ply), pictures (.png, .exr, .pfm). Put them after the scene, or repeat the option' -r -F
complete -c etendue -n "__fish_etendue_using_subcommand photons" -l map -d 'Which photons' -r -f -a "direct\t'Light straight from the emitters, and shadow photons behind what it meets'
caustic\t'Light that came by mirrors and glass only'
indirect\t'Light that was scattered diffusely before'
global\t'All light'"
complete -c etendue -n "__fish_etendue_using_subcommand photons" -l photons -d 'Light paths, in place of the scene\'s; 100000 where that has none' -r
complete -c etendue -n "__fish_etendue_using_subcommand photons" -l threads -d 'Threads; 0 takes all there are' -r
complete -c etendue -n "__fish_etendue_using_subcommand photons" -l seed -d 'Seed of all randomness, in place of the scene\'s' -r
complete -c etendue -n "__fish_etendue_using_subcommand photons" -l max-depth -d 'Greatest number of surface hits on a path, or none for no cut' -r
complete -c etendue -n "__fish_etendue_using_subcommand photons" -l resolution -d 'Width and height of a picture in pixels, in place of the scene\'s' -r
complete -c etendue -n "__fish_etendue_using_subcommand photons" -l origin -d 'Where a picture is seen from, such as 0,1,5, in place of the scene\'s camera' -r
complete -c etendue -n "__fish_etendue_using_subcommand photons" -l look-at -d 'A point in the middle of a picture' -r
complete -c etendue -n "__fish_etendue_using_subcommand photons" -l up -d 'Upwards in a picture' -r
complete -c etendue -n "__fish_etendue_using_subcommand photons" -l field-of-view -d 'Full angle of view of a picture, degrees' -r
complete -c etendue -n "__fish_etendue_using_subcommand photons" -l color -d 'Draw photons in the colour of their power instead of white'
complete -c etendue -n "__fish_etendue_using_subcommand photons" -s q -l quiet -d 'No summary; warnings and errors stay'
complete -c etendue -n "__fish_etendue_using_subcommand photons" -s h -l help -d 'Print help (see more with \'--help\')'
complete -c etendue -n "__fish_etendue_using_subcommand bake" -s o -l output -d 'What the files\' names begin with: PREFIX.exr (light map), PREFIX.obj (its coordinates), PREFIX.ply (vertices) and PREFIX.json (summary). Of a folder: the scene\'s name in it' -r -F
complete -c etendue -n "__fish_etendue_using_subcommand bake" -l method -d 'How light is found' -r -f -a "path\t'Path tracing: everything, with noise whose size is known'
radiosity\t'Radiosity: without noise, for diffuse scenes; elements as small as texels, unless the scene says how large'"
complete -c etendue -n "__fish_etendue_using_subcommand bake" -l only -d 'Only the light map, or only the vertices, instead of both' -r -f -a "map\t'The light map and its coordinates'
vertices\t'The vertices'"
complete -c etendue -n "__fish_etendue_using_subcommand bake" -l resolution -d 'Texels along the sides of the light map; 512 where --texels-per-unit is not given either' -r
complete -c etendue -n "__fish_etendue_using_subcommand bake" -l texels-per-unit -d 'Texels for a unit of length; as many as fit where only --resolution is given' -r
complete -c etendue -n "__fish_etendue_using_subcommand bake" -l gutter -d 'Texels around each chart that are its own' -r
complete -c etendue -n "__fish_etendue_using_subcommand bake" -l layout -d 'Where the layout of meshes comes from' -r -f -a "auto\t'A mesh\'s own texture coordinates where they are fit for it, else charts'
charts\t'Charts'
own\t'A mesh\'s own texture coordinates; an error where they are not fit for it'"
complete -c etendue -n "__fish_etendue_using_subcommand bake" -l spacing -d 'Greatest length of a triangle\'s side between vertices; the vertices as they are where none is given' -r
complete -c etendue -n "__fish_etendue_using_subcommand bake" -l memory -d 'Most memory for the light map and its work, MiB' -r
complete -c etendue -n "__fish_etendue_using_subcommand bake" -l threads -d 'Threads; 0 takes all there are' -r
complete -c etendue -n "__fish_etendue_using_subcommand bake" -l spp -d 'Samples per texel and vertex, in place of the scene\'s' -r
complete -c etendue -n "__fish_etendue_using_subcommand bake" -l time -d 'Stop each of both after so many seconds. With --spp, at whichever comes first; without, the scene\'s samples do not count' -r
complete -c etendue -n "__fish_etendue_using_subcommand bake" -l target-error -d 'Stop when the estimated relMSE over texels (or vertices) is no larger than this, such as 0.001' -r
complete -c etendue -n "__fish_etendue_using_subcommand bake" -l seed -d 'Seed of all randomness, in place of the scene\'s' -r
complete -c etendue -n "__fish_etendue_using_subcommand bake" -l shadow-rays -d 'Light samples per hit, in place of the scene\'s' -r
complete -c etendue -n "__fish_etendue_using_subcommand bake" -l max-depth -d 'Greatest number of surface hits on a path, the texel being the first, or none for no cut. 1 is direct light alone' -r
complete -c etendue -n "__fish_etendue_using_subcommand bake" -l exposure -d 'Brightness of the vertices\' display colours in stops: 1 doubles it' -r
complete -c etendue -n "__fish_etendue_using_subcommand bake" -l back -d 'The inner side of surfaces instead of the outer one'
complete -c etendue -n "__fish_etendue_using_subcommand bake" -s q -l quiet -d 'No progress and no summary; warnings and errors stay'
complete -c etendue -n "__fish_etendue_using_subcommand bake" -s h -l help -d 'Print help (see more with \'--help\')'
complete -c etendue -n "__fish_etendue_using_subcommand lux" -l grid -d 'File of grids: planes, points and views, each with a name (docs/photometry.md)' -r -F
complete -c etendue -n "__fish_etendue_using_subcommand lux" -l plane -d 'A plane in place of a file, or beside it: a corner, two sides and the numbers of points along them, such as 0,0.8,0 0,0,3 4,0,0 6x8. Its normal is that of the first side times the second' -r
complete -c etendue -n "__fish_etendue_using_subcommand lux" -l normal -d 'The normal of --plane, in place of its own' -r
complete -c etendue -n "__fish_etendue_using_subcommand lux" -s o -l output -d 'Files to write, by extension: tables (.csv), results as one object (.json), false-colour pictures of all planes (.png). The table for people goes to standard output in any case' -r -F
complete -c etendue -n "__fish_etendue_using_subcommand lux" -l method -d 'How light is found' -r -f -a "path\t'Path tracing: everything, without bias'
radiosity\t'A radiosity solution, whose light is gathered at each point: for diffuse scenes'"
complete -c etendue -n "__fish_etendue_using_subcommand lux" -l error -d 'Stop a grid when its relative standard error is no larger than this: the root of the mean square over its points. 0.01 where nothing else limits the work' -r
complete -c etendue -n "__fish_etendue_using_subcommand lux" -l spp -d 'Most samples per point; 1048576 unless --time is given' -r
complete -c etendue -n "__fish_etendue_using_subcommand lux" -l time -d 'Stop each grid after so many seconds' -r
complete -c etendue -n "__fish_etendue_using_subcommand lux" -l max-depth -d 'Greatest number of surface hits on a path, the point being the first, or none for no cut. 1 is direct light alone. Not with radiosity' -r
complete -c etendue -n "__fish_etendue_using_subcommand lux" -l shadow-rays -d 'Light samples per hit, in place of the scene\'s' -r
complete -c etendue -n "__fish_etendue_using_subcommand lux" -l seed -d 'Seed of all randomness, in place of the scene\'s' -r
complete -c etendue -n "__fish_etendue_using_subcommand lux" -l threads -d 'Threads; 0 takes all there are' -r
complete -c etendue -n "__fish_etendue_using_subcommand lux" -l scale -d 'Value at the upper end of a picture\'s scale, in place of a round one above the greatest' -r
complete -c etendue -n "__fish_etendue_using_subcommand lux" -l daylight -d 'Daylight factors: the sky alone lights the scene, and illuminance is given in per cent of that outside too'
complete -c etendue -n "__fish_etendue_using_subcommand lux" -s q -l quiet -d 'No progress and no notes; the table, warnings and errors stay'
complete -c etendue -n "__fish_etendue_using_subcommand lux" -s h -l help -d 'Print help (see more with \'--help\')'
complete -c etendue -n "__fish_etendue_using_subcommand compare" -l exposure -d 'Brightness at which FLIP looks at the images, in stops' -r
complete -c etendue -n "__fish_etendue_using_subcommand compare" -l json -d 'Print one JSON object; what is not finite is null'
complete -c etendue -n "__fish_etendue_using_subcommand compare" -l no-flip -d 'Leave out FLIP, the slow one'
complete -c etendue -n "__fish_etendue_using_subcommand compare" -s h -l help -d 'Print help'
complete -c etendue -n "__fish_etendue_using_subcommand bench" -l suite -d 'Suite file (JSON) with groups of cases, in place of scenes' -r -F
complete -c etendue -n "__fish_etendue_using_subcommand bench" -s o -l output -d 'Folder for results.json, results.md, report.html and the pictures; made where it is missing. Beside the results with --report-only, else out/bench where none is given' -r -F
complete -c etendue -n "__fish_etendue_using_subcommand bench" -l integrators -d 'Light transport to compare, separated by commas; the scene\'s where none is given' -r -f -a "path\t'Path tracing: all light, by paths from the camera'
whitted\t'Direct light, perfect mirrors and glass; no diffuse interreflection'
direct\t'Emission and light scattered once'
photon_direct\t'The report\'s photon map: direct light from photons, where no shadow photon is among them'
caustic\t'Path tracing, with caustics from a photon map'
photon\t'A global and a caustic photon map, with final gathering'
irradiance_cache\t'All light, with indirect diffuse light interpolated between final gathers'
radiosity\t'The diffuse scene solved as a whole, for every view of it'
ppm\t'Progressive photon mapping: a new map every pass, with one shrinking radius'
sppm\t'Stochastic progressive photon mapping: a new map every pass, with radii that shrink pixel by pixel'
auto\t'Path tracing, path tracing with a caustic map, or stochastic progressive photon mapping, by what the scene holds; the irradiance cache where a bias is allowed'"
complete -c etendue -n "__fish_etendue_using_subcommand bench" -l samplers -d 'Samplers to compare, separated by commas; the scene\'s where none is given' -r -f -a "sobol\t'Owen-scrambled Sobol\' points'
random\t'Independent random numbers'
jittered\t'One random position in each of n x n cells'
grid\t'n x n regular positions'
gaussian\t'Normally distributed around the pixel\'s centre'"
complete -c etendue -n "__fish_etendue_using_subcommand bench" -l spp -d 'Samples per pixel to try, separated by commas; 16,64,256 where there is neither --spp nor --time' -r
complete -c etendue -n "__fish_etendue_using_subcommand bench" -l time -d 'Seconds to try, separated by commas' -r
complete -c etendue -n "__fish_etendue_using_subcommand bench" -l threads -d 'Numbers of threads to try, separated by commas; 0 takes all there are' -r
complete -c etendue -n "__fish_etendue_using_subcommand bench" -l resolution -d 'Width and height in pixels, such as 256x256, in place of the scene\'s' -r
complete -c etendue -n "__fish_etendue_using_subcommand bench" -l runs -d 'Runs of each case, each with a seed of its own; the suite\'s number, or 5' -r
complete -c etendue -n "__fish_etendue_using_subcommand bench" -l references -d 'Folder of references, NAME-WxH.exr; what is missing is path traced and kept there. References in the output folder where none is given' -r -F
complete -c etendue -n "__fish_etendue_using_subcommand bench" -l reference-spp -d 'Samples per pixel of references that are made; the suite\'s number, or four times the most that is measured and at least 1024' -r
complete -c etendue -n "__fish_etendue_using_subcommand bench" -l include -d 'Results of other renderers (JSON) that the report shows beside; may be repeated' -r -F
complete -c etendue -n "__fish_etendue_using_subcommand bench" -l report-only -d 'Render nothing, and make the report of these results anew' -r -F
complete -c etendue -n "__fish_etendue_using_subcommand bench" -l tables -d 'Markdown file in which the tables between <!-- bench GROUP --> and <!-- /bench --> are written anew' -r -F
complete -c etendue -n "__fish_etendue_using_subcommand bench" -s q -l quiet -d 'No progress and no summary; warnings and errors stay'
complete -c etendue -n "__fish_etendue_using_subcommand bench" -s h -l help -d 'Print help (see more with \'--help\')'
complete -c etendue -n "__fish_etendue_using_subcommand help; and not __fish_seen_subcommand_from render convert merge info photons bake lux compare bench help" -f -a "render" -d 'Render a scene to image files'
complete -c etendue -n "__fish_etendue_using_subcommand help; and not __fish_seen_subcommand_from render convert merge info photons bake lux compare bench help" -f -a "convert" -d 'Write any scene as a scene file of the native format, with its meshes and images beside it'
complete -c etendue -n "__fish_etendue_using_subcommand help; and not __fish_seen_subcommand_from render convert merge info photons bake lux compare bench help" -f -a "merge" -d 'Put the parts of a picture together that were rendered by several processes'
complete -c etendue -n "__fish_etendue_using_subcommand help; and not __fish_seen_subcommand_from render convert merge info photons bake lux compare bench help" -f -a "info" -d 'Say what a scene holds, what was built for it and why'
complete -c etendue -n "__fish_etendue_using_subcommand help; and not __fish_seen_subcommand_from render convert merge info photons bake lux compare bench help" -f -a "photons" -d 'Write the photons of a map, or draw them'
complete -c etendue -n "__fish_etendue_using_subcommand help; and not __fish_seen_subcommand_from render convert merge info photons bake lux compare bench help" -f -a "bake" -d 'Bake light maps: the irradiance of all surfaces, in texels and at vertices'
complete -c etendue -n "__fish_etendue_using_subcommand help; and not __fish_seen_subcommand_from render convert merge info photons bake lux compare bench help" -f -a "lux" -d 'Calculate illuminance [lx] and luminance [cd/m²] at points, with the figures of lighting design'
complete -c etendue -n "__fish_etendue_using_subcommand help; and not __fish_seen_subcommand_from render convert merge info photons bake lux compare bench help" -f -a "compare" -d 'Measure how far image A is from the reference B'
complete -c etendue -n "__fish_etendue_using_subcommand help; and not __fish_seen_subcommand_from render convert merge info photons bake lux compare bench help" -f -a "bench" -d 'Measure time and error of scenes against references, and write a report'
complete -c etendue -n "__fish_etendue_using_subcommand help; and not __fish_seen_subcommand_from render convert merge info photons bake lux compare bench help" -f -a "help" -d 'Print this message or the help of the given subcommand(s)'
