# What Recto says to visitors, in English. A museum changes it without touching this file: a folder
# of its own with files named LANGUAGE.ftl, each with the messages that are to read otherwise.
# Names in { $… } are filled in by the program. Labels of buttons have at most 14 letters.

# The name of this language in itself.
language-name = English

## Controls

flip = Turn over
lamp = Lamp
scenes = Views
compare = Compare
overlays = Layers
light-table = Light table
measure = Measure
home = Start
language = Language
text-size = Text size
contrast = Contrast
motion = Motion
help = Help
close = Close
next = Next
previous = Previous
back = Back
done = Done
take-back = Undo
more = More
enlarge = Larger text
normal-size = Normal text
high-contrast = High contrast
reduced-motion = Less motion
zoom-in = Closer
zoom-out = Further
true-size = True size
hotspots = Details
caption = Caption
legend = Legend

## The sheet

recto = Recto
verso = Verso
before = Before
after = After

## Lamp

zenithal = Overhead
oblique = At 45°
raking-left = From left
raking-right = From right
raking-top = From top
raking-bottom = From bottom
intensity = Brightness
brighter = Brighter
dimmer = Dimmer
warmer = Warmer
cooler = Cooler
# How high the lamp stands above the sheet, in degrees.
lamp-elevation = { $elevation }° high
# The direction from which it shines, in degrees anticlockwise from the right.
lamp-azimuth = from { $azimuth }°
intensity-times = Brightness × { $times }
light-table-share = Light table { $share }%
colour-temperature = { $kelvin } K
lamp-overhead = lamp overhead
# $from is one of right, upper-right, top, upper-left, left, lower-left, bottom, lower-right.
lamp-place = lamp { $elevation }° high, from { $from ->
        [right] the right
        [upper-right] the upper right
        [top] the top
        [upper-left] the upper left
        [left] the left
        [lower-left] the lower left
        [bottom] the bottom
       *[lower-right] the lower right
    } ({ $azimuth }°)

## Comparisons and layers

curtain = Curtain
side-by-side = Side by side
blend = Blend
loupe = Loupe
difference = Difference
flicker = In turns
glass = Through sheet
opacity = Strength
opacity-share = Strength { $share }%
no-overlay = No layer
no-state = the sheet itself
comparing-curtain = curtain
comparing-side-by-side = side by side
comparing-blend = blend, { $share }% of the second
comparing-loupe = loupe, { $times } times
comparing-difference = difference
comparing-flicker = in turns, number { $number }
comparing-glass = through the sheet, { $share }% of the other side
light-through = { $share }% of the light through the sheet

## Measuring

ruler = Ruler
line = Path
area = Area
angle = Angle
profile = Relief
laid-lines = Laid lines
stroke = Stroke
probe = Colour
reading-out = What lies here
ruler-hint = Touch two places
line-hint = Touch place after place, the last one twice
area-hint = Touch its corners, the last one twice
angle-hint = Touch three places; the second is the corner
profile-hint = Touch both ends of a line
laid-lines-hint = Touch two corners of a region without holes
stroke-hint = Touch the paper on both sides of the stroke
probe-hint = Touch one place
difference-hint = Touch two places on one sheet
reading-hint = Touch the sheet to read what lies there

## Caption

at-true-size = true size
at-true-size-perhaps = true size, if the display has 96 pixels an inch
no-hotspots = no details on this side
# Where a detail leads.
hotspot-leads = Touch again: { $title }

## Hints

touch-to-turn = One finger turns the sheet
pinch-to-zoom = Two fingers bring it closer
drag-lamp = Hold the lamp and move it
two-visitors = One of you may hold the sheet, another the lamp
attract-invitation = Touch the sheet
countdown = { $seconds ->
        [one] Back to the start in { $seconds } second
       *[other] Back to the start in { $seconds } seconds
    }
stay = I am still here
closed = Closed

## Staff

staff-pin = Staff PIN
staff-wrong = Wrong PIN
staff-wait = { $seconds ->
        [one] Wait { $seconds } second
       *[other] Wait { $seconds } seconds
    }
staff-quit = Quit Recto
staff-restart = Restart
staff-next-exhibit = Next exhibit
staff-hours-off = Stay open now
staff-status = Status
