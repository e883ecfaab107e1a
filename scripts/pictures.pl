#!/usr/bin/perl
# Draws docs/gallery.md: every scene, every method with its error, photon maps, and a light map, each with the time that it took.
#
#   scripts/pictures.pl [--quick] ETENDUE     ETENDUE is the command line; --quick takes a tenth of the time
#
# The pictures go to docs/gallery/shown/. Seconds are those of this machine.
use strict;
use warnings;
use Compress::Zlib qw(compress crc32);
use Cwd qw(abs_path);
use File::Basename qw(dirname);
use File::Temp qw(tempdir);
use JSON::PP;

my $root = abs_path(dirname($0) . '/..');
my $json = JSON::PP->new->utf8->canonical->allow_nonref;
my $is_quick = @ARGV && $ARGV[0] eq '--quick' && shift;
my $etendue = abs_path(shift // die "the command line is missing: scripts/pictures.pl ETENDUE\n");
my $work = tempdir(CLEANUP => 1);
my $out = "$root/docs/gallery/shown";
my $page = "$root/docs/gallery.md";
my $scale = $is_quick ? 0.1 : 1;
mkdir $out;
chdir $root or die "$root: $!\n";

sub slurp { my ($path) = @_; local $/; open my $file, '<:raw', $path or die "$path: $!\n"; return scalar <$file>; }
sub spew { my ($path, $bytes) = @_; open my $file, '>:raw', $path or die "$path: $!\n"; print $file $bytes; close $file or die "$path: $!\n"; }
sub run { system(@_) == 0 or die "failed: @_\n"; }

# Significant digits, as 3.2e-4 or 0.012.
sub short { my ($x) = @_; return $x >= 0.01 ? sprintf('%.2g', $x) : sprintf('%.1e', $x) =~ s/e([-+])0/e$1/r; }

# A picture of `width` pixels in so many seconds; the statistics.
sub render {
    my ($scene, $name, $size, $seconds, @more) = @_;
    my $stats = "$work/$name.json";
    run($etendue, 'render', $scene, '--quiet', '--resolution', $size, '--time', $seconds * $scale, '--stats', $stats,
        '--output', "$out/$name.png", "$work/$name.pfm", @more);
    return $json->decode(slurp($stats));
}

# The size of a scene's picture, so many pixels wide.
sub size_of {
    my ($scene, $width) = @_;
    my ($w, $h) = @{ $json->decode(slurp($scene))->{render}{resolution} };
    return sprintf('%dx%d', $width, $width * $h / $w);
}

# Width, height and values of a PFM, row 0 on top.
sub read_pfm {
    my ($path) = @_;
    my ($w, $h, $order, $bytes) = slurp($path) =~ /\APF\s(\d+)\s(\d+)\s(\S+)\s(.*)\z/s or die "$path is no PFM\n";
    my @values = unpack($order < 0 ? 'f<*' : 'f>*', $bytes);
    my @rows = map { [@values[3 * $w * $_ .. 3 * $w * ($_ + 1) - 1]] } reverse 0 .. $h - 1;
    return ($w, $h, \@rows);
}

sub write_png {
    my ($path, $w, $h, $rows) = @_;
    my $chunk = sub { my ($type, $data) = @_; pack('N', length $data) . $type . $data . pack('N', crc32($type . $data)) };
    my $pixels = join '', map { "\0" . pack('C*', @$_) } @$rows;
    my $head = pack('NNCCCCC', $w, $h, 8, 2, 0, 0, 0);
    spew($path, "\x89PNG\r\n\x1a\n" . $chunk->('IHDR', $head) . $chunk->('IDAT', compress($pixels, 9)) . $chunk->('IEND', ''));
}

# Where a picture is brighter than the reference (red) and where darker (blue): white are 30 % and more.
sub draw_error {
    my ($name, $reference) = @_;
    my ($w, $h, $a) = read_pfm("$work/$name.pfm");
    my (undef, undef, $b) = read_pfm("$work/$reference.pfm");
    my (@rows, $sum);
    $sum += $_ for map { @$_ } @$b;
    my $floor = 0.1 * $sum / (3 * $w * $h);
    for my $y (0 .. $h - 1) {
        my @row;
        for my $x (0 .. $w - 1) {
            my ($own, $true) = map { my $row = $_; ($row->[3 * $x] + $row->[3 * $x + 1] + $row->[3 * $x + 2]) / 3 } $a->[$y], $b->[$y];
            my $off = ($own - $true) / ($true + $floor) / 0.3;
            my $much = abs $off > 1 ? 1 : abs $off;
            my ($bright, $other) = (int(255 * sqrt $much), int(255 * $much * $much));
            push @row, $off > 0 ? ($bright, $other, $other) : ($other, $other, $bright);
        }
        push @rows, \@row;
    }
    write_png("$out/$name-error.png", $w, $h, \@rows);
}

# A table of cells, so many in a row.
sub table {
    my ($across, @cells) = @_;
    my $text = '|' . '  |' x $across . "\n|" . '---|' x $across . "\n";
    while (my @row = splice @cells, 0, $across) {
        push @row, '' while @row < $across;
        $text .= '| ' . join(' | ', @row) . " |\n";
    }
    return $text;
}

my $text = '';

# Every scene.
my @cells;
for my $path (sort glob 'scenes/*.json') {
    my ($name) = $path =~ m{([^/]+)\.json$};
    next if $name eq 'million' && !-e 'out/million.obj';
    my $stats = render($path, "scene-$name", size_of($path, 240), 2);
    my $ways = join '', map { $stats->{settings}{$_->[0]} ? ", $_->[1]" : '' } ['reuse', 'shared hits'], ['lightPaths', 'light paths'], ['spectral', 'wavelengths'];
    $ways .= ", $stats->{settings}{firstShadowRays} light samples first" if $stats->{settings}{firstShadowRays} > $stats->{settings}{shadowRays};
    my $anchor = $name =~ /^caustic-/ ? 'caustic-room-caustic-mirror-caustic-glass' : $name;
    push @cells, sprintf('![%s](gallery/shown/scene-%s.png)<br>[%s](scenes.md#%s): %s%s<br>%d samples, %.1f s, relMSE %s',
        $name, $name, $name, $anchor, $stats->{settings}{integrator}, $ways, $stats->{samples}{mean}, $stats->{seconds}{render},
        defined $stats->{relMSE}{value} ? short($stats->{relMSE}{value}) : 'unknown');
    print "$name\n";
}
$text .= "## Every scene\n\nBy the integrator of its file, in two seconds. The relMSE is the one that the render estimates.\n\n" . table(3, @cells) . "\n";

# Every method.
@cells = ();
my $room = 'scenes/room.json';
render($room, 'method-reference', '200x200', 45, '--integrator', 'path');
for my $method (qw(path whitted direct photon_direct caustic photon irradiance_cache ppm sppm radiosity auto)) {
    my $stats = render($room, "method-$method", '200x200', 4, '--integrator', $method);
    my $far = $json->decode(scalar `'$etendue' compare --json --no-flip '$work/method-$method.pfm' '$work/method-reference.pfm'`);
    draw_error("method-$method", 'method-reference');
    my $error = $far->{rel_mse} // die "compare has no rel_mse\n";
    push @cells, sprintf('![%s](gallery/shown/method-%s.png)<br>![its error](gallery/shown/method-%s-error.png)<br>`%s`<br>%d samples, %.1f s, relMSE %s',
        $method, $method, $method, $method, $stats->{samples}{mean}, $stats->{seconds}{render}, short($error));
    print "$method\n";
}
unlink "$out/method-reference.png";
$text .= "## Every method\n\nThe report's room in four seconds, or what the preparation takes, and where it is off from 45 seconds of `path`: red is too bright, blue too dark, white by 30 % or more. "
    . "The relMSE is measured against these 45 seconds, whose own noise it holds, so that it holds what a method leaves out (`whitted` and `direct` most indirect light, `radiosity` mirrors and glass).\n\n"
    . table(3, @cells) . "\n";

# Photon maps.
@cells = ();
for my $map (qw(direct caustic indirect global)) {
    run($etendue, 'photons', $room, '--map', $map, '--photons', int(200_000 * $scale), '--output', "$out/photons-$map.png");
    push @cells, "![$map](gallery/shown/photons-$map.png)<br>`--map $map`";
}
$text .= "## Photon maps\n\n`etendue photons scenes/room.json --map …` with 200,000 light paths, seen by the scene's camera.\n\n" . table(2, @cells) . "\n";

# A light map, as a backplate shows it.
run($etendue, 'bake', $room, '--quiet', '--only', 'map', '--resolution', 400, '--time', 8 * $scale, '--output', "$work/map");
my $baked = $json->decode(slurp("$work/map.json"))->{map};
my %shown = (
    etendue => 1, camera => { origin => [0, 0, 0] },
    textures => [{ name => 'map', type => 'image', file => 'map.exr', filter => 'nearest' }],
    backplate => { texture => 'map', intensity => 0.3 },
);
spew("$work/shown.json", $json->encode(\%shown));
run($etendue, 'render', "$work/shown.json", '--quiet', '--resolution', '400x400', '--spp', 1, '--output', "$out/light-map.png");
$text .= sprintf("## Light map\n\n`etendue bake scenes/room.json --resolution 400`, %d samples, %.1f s, relMSE %s: the irradiance of all surfaces, each chart in a place of its own ([bake.md](bake.md)).\n\n![light map](gallery/shown/light-map.png)\n",
    $baked->{samples}, $baked->{seconds}, short($baked->{relMSE}));

my $head = <<'HEAD';
# Gallery

What the library draws, with the time that it took on the machine where `make pictures` drew it. Pictures of every material are in
[materials.md](materials.md#gallery), what to look for in each scene in [scenes.md](scenes.md), and measured comparisons in
[performance.md](performance.md) and [benchmarks-peers.md](benchmarks-peers.md).

HEAD
spew($page, $head . $text);
