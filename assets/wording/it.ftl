# Quello che Recto dice ai visitatori, in italiano.

language-name = Italiano

## Comandi

flip = Gira
lamp = Lampada
scenes = Vedute
compare = Confronta
overlays = Livelli
light-table = Controluce
measure = Misura
home = Inizio
language = Lingua
text-size = Testo
contrast = Contrasto
motion = Movimento
help = Aiuto
close = Chiudi
next = Avanti
previous = Precedente
back = Indietro
done = Fatto
take-back = Annulla
more = Altro
enlarge = Testo grande
normal-size = Testo normale
high-contrast = Alto contrasto
reduced-motion = Meno movimento
zoom-in = Più vicino
zoom-out = Più lontano
true-size = Formato reale
hotspots = Dettagli
caption = Didascalia
legend = Legenda

## Il foglio

recto = Recto
verso = Verso
before = Prima
after = Dopo

## Lampada

zenithal = Zenitale
oblique = A 45°
raking-left = Da sinistra
raking-right = Da destra
raking-top = Dall’alto
raking-bottom = Dal basso
intensity = Luminosità
brighter = Più chiaro
dimmer = Più scuro
warmer = Più calda
cooler = Più fredda
lamp-elevation = altezza { $elevation }°
lamp-azimuth = da { $azimuth }°
intensity-times = Luminosità × { $times }
light-table-share = Controluce { $share }%
colour-temperature = { $kelvin } K
lamp-overhead = lampada a perpendicolo
lamp-place = lampada a { $elevation }° di altezza, { $from ->
        [right] da destra
        [upper-right] dall’alto a destra
        [top] dall’alto
        [upper-left] dall’alto a sinistra
        [left] da sinistra
        [lower-left] dal basso a sinistra
        [bottom] dal basso
       *[lower-right] dal basso a destra
    } ({ $azimuth }°)

## Confronti e livelli

curtain = Sipario
side-by-side = Affiancati
blend = Dissolvenza
loupe = Lente
difference = Differenza
flicker = Alternati
glass = In trasparenza
opacity = Intensità
opacity-share = Intensità { $share }%
no-overlay = Nessun livello
no-state = il foglio così com’è
comparing-curtain = sipario
comparing-side-by-side = affiancati
comparing-blend = dissolvenza, { $share }% del secondo
comparing-loupe = lente, { $times } ingrandimenti
comparing-difference = differenza
comparing-flicker = alternati, numero { $number }
comparing-glass = in trasparenza, { $share }% dell’altro lato
light-through = { $share }% della luce attraverso il foglio

## Misurare

ruler = Righello
line = Percorso
area = Area
angle = Angolo
profile = Rilievo
laid-lines = Vergelle
stroke = Tratto
probe = Colore
reading-out = Che cosa c’è qui
ruler-hint = Tocca due punti
line-hint = Tocca un punto dopo l’altro, l’ultimo due volte
area-hint = Tocca gli angoli, l’ultimo due volte
angle-hint = Tocca tre punti; il secondo è il vertice
profile-hint = Tocca i due estremi di una linea
laid-lines-hint = Tocca due angoli di una zona senza fori
stroke-hint = Tocca la carta ai due lati del tratto
probe-hint = Tocca un punto
difference-hint = Tocca due punti dello stesso foglio
reading-hint = Tocca il foglio per leggere che cosa c’è

## Didascalia

at-true-size = formato reale
at-true-size-perhaps = formato reale, se lo schermo ha 96 pixel per pollice
tier-draft = bozza
tier-study = studio
no-hotspots = nessun dettaglio su questo lato
hotspot-leads = Tocca ancora: { $title }

## Legenda

legend-layer = { $title } · { $share }%
legend-luminance = { $value } della luminanza del bianco
legend-band = riflettanza a { $band }
legend-difference = riflettanza a { $first } − { $second }
legend-bands = rosso { $red }, verde { $green }, blu { $blue }
enhanced-relief = solo rilievo, senza colore
enhanced-steepness = rilievo { $times } volte più ripido
enhanced-contrast = contrasto esteso: dal { $low } al { $high }% del bianco
enhanced-sharpness = nitidezza: { $share }%

## Suggerimenti

touch-to-turn = Con un dito giri il foglio
touch-to-move = Con un dito sposti il foglio
pinch-to-zoom = Con due dita lo avvicini
drag-lamp = Tieni la lampada e spostala
two-visitors = Uno può tenere il foglio, un altro la lampada
attract-invitation = Tocca il foglio
countdown = { $seconds ->
        [one] Si torna all’inizio tra { $seconds } secondo
        [many] Si torna all’inizio tra { $seconds } secondi
       *[other] Si torna all’inizio tra { $seconds } secondi
    }
stay = Sono ancora qui
closed = Chiuso

## Personale

staff-pin = PIN del personale
staff-wrong = PIN errato
staff-wait = { $seconds ->
        [one] Attendere { $seconds } secondo
        [many] Attendere { $seconds } secondi
       *[other] Attendere { $seconds } secondi
    }
staff-quit = Esci da Recto
staff-restart = Riavvia
staff-next-exhibit = Mostra successiva
staff-chart = Scheda di prova
staff-hours-off = Lascia aperto ora
staff-panel = Personale

## Misure

reading = { $quantity }: { $value }
reading-none = { $quantity }: nessuno
reading-waiting = misura in corso…
reading-nothing = qui non c’è nulla da misurare
reading-none-why = { $quantity }: nessuno, { $why }
reading-failed = non misurato: { $why }
why-off-sheet = un punto è fuori dal foglio
why-too-wide = è più largo del foglio
why-no-picture = questo lato non ha immagine
why-no-height = il rilievo di questo lato non è stato rilevato
why-unreadable = un file non si può leggere
why-gone = il disegno o il suo stato non c’è più
why-one-place = due punti sono troppo vicini
why-crosses-itself = il contorno si incrocia
why-no-area = gli angoli stanno su una sola linea
why-no-stroke = qui non c’è un tratto
why-several-strokes = qui c’è più di un tratto
why-no-paper = non c’è carta nuda ai due estremi
why-oblique = il tratto è obliquo di { $degrees }°; gira la linea
why-too-little = troppo poco è sul foglio
why-coarse = l’immagine è troppo grossolana
why-small = la zona è troppo piccola
why-covered = c’è troppo disegno
why-faint = nessuna linea si distingue
note-unregistered = non si sa con quale precisione { $file } sia sul foglio; non è compreso nell’incertezza
note-fitted = { $file } è adattato, non misurato: l’incertezza è quella della lettura
note-assumed = { $file } è ipotizzato, non misurato: l’incertezza è quella della lettura
note-no-picture = questo lato non ha immagine: l’incertezza è solo quella del puntare
note-stroke = letto da { $file } a metà profondità, su { $length } del tratto
note-lines = letto da { $file }; direzioni in senso orario dall’orizzontale
note-colours = colori di { $file } alla luce del giorno (D65), qualunque sia la lampada
under-place = { $across } mm da sinistra, { $down } mm dall’alto
under-nothing = niente
under-false-colour = falso colore, rosso { $red }, verde { $green }, blu { $blue }
under-reflectance = { $value } di riflettanza
quantity-length = lunghezza
quantity-area = area
quantity-perimeter = perimetro
quantity-angle = angolo
quantity-width = larghezza
quantity-height = altezza
quantity-roughness = rugosità
quantity-trend = pendenza
quantity-laid-spacing = passo delle vergelle
quantity-laid-direction = direzione delle vergelle
quantity-chain-spacing = passo dei filoni
quantity-chain-direction = direzione dei filoni
quantity-difference = differenza ΔE00

## Avvisi

saved = salvata come veduta { $name }
not-saved = non salvata: il terminale dice perché
not-saved-changed = non salvata: nel frattempo il manifesto è cambiato
not-saved-read-only = non salvata: il manifesto è di sola lettura
not-saved-unwritable = non salvata: il manifesto non si può scrivere
not-saved-at-fault = non salvata: il manifesto contiene errori
link-printed = un collegamento è nel terminale
exporting = esportazione in { $file }…
exported = esportato: { $file }
not-exported = non esportato: il terminale dice perché

## Tastiera e mouse

keys-drag = trascinare
keys-wheel = rotella, + −
keys-double-click = doppio clic
keys-arrows = frecce
keys-lamp = trascinare col destro, L + trascinare, Maiusc + frecce
keyboard-shift = Maiusc
keyboard-control = Ctrl
keyboard-enter = Invio
keyboard-backspace = Backspace
keyboard-space = Spazio
key-turn = girare il foglio; spostarlo da vicino
key-zoom = più vicino, più lontano
key-true-size = formato reale e ritorno
key-move = spostare da vicino
key-flip = girare il foglio
key-lamp = spostare la lampada
key-presets = lampada zenitale, a 45°, radente
key-state = stato successivo, precedente
key-overlays = livelli: nessuno, uno alla volta, tutti
key-opacity = livelli più deboli, più forti
key-category = categoria successiva da sola, precedente
key-compare = confronto successivo, precedente
key-share = spostare il sipario, più o meno dissolvenza
key-angle = girare il sipario, lente più grande, ΔE00 o luce
key-through = meno, più luce attraverso il foglio
key-enhance = solo rilievo, più ripido, contrasto, più nitido
key-scene = veduta successiva, precedente
key-home = la veduta com’era
key-hotspots = dettagli: un clic per aprirlo, due per andarci
key-next-hotspot = dettaglio successivo, precedente, alla sua veduta
key-next-control = comando successivo, precedente, usarlo
key-controls = comandi
key-measure = strumento di misura successivo, precedente: clic per posarlo
key-end-path = chiudere un percorso, annullare un punto o una misura
key-under = che cosa c’è sotto il puntatore
key-save = salvare la veduta
key-link = stampare un collegamento alla veduta
key-export = esportare una figura, o la sua luce in EXR
key-tier = grado di accuratezza successivo, precedente
key-caption = didascalia
key-escape = schermo intero, riporre, chiudere o uscire
