#!/usr/bin/perl
# Draws the gallery of materials (docs/materials.md): scenes/gallery/ball.json with the materials of each entry of
# scenes/gallery/materials.json, of which the one named `shown` is the ball's, to docs/gallery/PICTURE.png. And the scenes that
# docs/scenes.md shows, to docs/gallery/scene-NAME.png.
#
#   scripts/gallery.pl [--samples N] ETENDUE [PICTURE ...]    ETENDUE is the command line; all pictures without a name
use strict;
use warnings;
use Cwd qw(abs_path);
use File::Basename qw(dirname);
use JSON::PP;

my $root = abs_path(dirname($0) . '/..');
my $json = JSON::PP->new->utf8->canonical->allow_nonref;
my @options;
if (@ARGV && $ARGV[0] eq '--samples') { shift; @options = ('--spp', shift // die "--samples: how many?\n"); }
my $etendue = shift // die "the command line is missing: scripts/gallery.pl ETENDUE [PICTURE ...]\n";

sub slurp { my ($path) = @_; local $/; open my $file, '<', $path or die "$path: $!\n"; return scalar <$file>; }

my $entries = $json->decode(slurp("$root/scenes/gallery/materials.json"));
my @scenes = map { "scene-$_" } qw(black-bodies diamond prism soap);
my %known = map { $_ => 1 } @scenes, map { $_->{picture} } @$entries;
for my $name (@ARGV) { die "no picture is called $name\n" unless $known{$name}; }
my %wanted = map { $_ => 1 } @ARGV ? @ARGV : keys %known;
mkdir "$root/docs/gallery";

sub draw {
    my ($scene, $picture) = @_;
    system($etendue, 'render', $scene, '--output', "$root/docs/gallery/$picture.png", '--quiet', @options) == 0
        or die "$picture could not be drawn\n";
    print "docs/gallery/$picture.png\n";
}

for my $picture (grep { $wanted{$_} } @scenes) {
    draw("$root/scenes/" . $picture =~ s/^scene-//r . '.json', $picture);
}

# The scene lies beside the floor's file, which it names, and goes in any case.
my $scene = "$root/scenes/gallery/.drawn.json";
END { unlink $scene if defined $scene; }
$SIG{$_} = sub { exit 1 } for qw(INT TERM HUP);
for my $entry (grep { $wanted{$_->{picture}} } @$entries) {
    my $template = $json->decode(slurp("$root/scenes/gallery/ball.json"));
    my @others = grep { $_->{name} ne 'shown' } @{$template->{materials}};
    $template->{materials} = [@others, @{$entry->{materials}}];
    open my $file, '>', $scene or die "$scene: $!\n";
    print $file $json->encode($template);
    close $file or die "$scene: $!\n";
    draw($scene, $entry->{picture});
}
