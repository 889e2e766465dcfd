# Ce que Recto dit aux visiteurs, en français.

language-name = Français

## Commandes

flip = Retourner
lamp = Lampe
scenes = Vues
compare = Comparer
overlays = Calques
light-table = Rétroéclairage
measure = Mesurer
home = Accueil
language = Langue
text-size = Texte
contrast = Contraste
motion = Mouvement
help = Aide
close = Fermer
next = Suivant
previous = Précédent
back = Retour
done = Terminé
take-back = Annuler
more = Plus
enlarge = Texte agrandi
normal-size = Texte normal
high-contrast = Fort contraste
reduced-motion = Moins animé
zoom-in = Plus près
zoom-out = Plus loin
true-size = Taille réelle
hotspots = Détails
caption = Cartel
legend = Légende

## La feuille

recto = Recto
verso = Verso
before = Avant
after = Après

## Lampe

zenithal = Zénithale
oblique = À 45°
raking-left = De gauche
raking-right = De droite
raking-top = Du haut
raking-bottom = Du bas
intensity = Luminosité
brighter = Plus clair
dimmer = Plus sombre
warmer = Plus chaud
cooler = Plus froid
lamp-elevation = hauteur { $elevation }°
lamp-azimuth = direction { $azimuth }°
intensity-times = Luminosité × { $times }
light-table-share = Rétroéclairage { $share } %
colour-temperature = { $kelvin } K
lamp-overhead = lampe au zénith
lamp-place = lampe à { $elevation }° de hauteur, { $from ->
        [right] de droite
        [upper-right] d’en haut à droite
        [top] d’en haut
        [upper-left] d’en haut à gauche
        [left] de gauche
        [lower-left] d’en bas à gauche
        [bottom] d’en bas
       *[lower-right] d’en bas à droite
    } ({ $azimuth }°)

## Comparaisons et calques

curtain = Rideau
side-by-side = Côte à côte
blend = Fondu
loupe = Loupe
difference = Différence
flicker = Tour à tour
glass = Transparence
opacity = Intensité
opacity-share = Intensité { $share } %
no-overlay = Aucun calque
no-state = la feuille elle-même
comparing-curtain = rideau
comparing-side-by-side = côte à côte
comparing-blend = fondu, { $share } % du second
comparing-loupe = loupe, { $times } fois
comparing-difference = différence
comparing-flicker = tour à tour, numéro { $number }
comparing-glass = par transparence, { $share } % de l’autre face
light-through = { $share } % de la lumière à travers la feuille

## Mesurer

ruler = Règle
line = Tracé
area = Surface
angle = Angle
profile = Relief
laid-lines = Vergeures
stroke = Trait
probe = Couleur
reading-out = Ce qui est ici
ruler-hint = Touchez deux points
line-hint = Touchez un point après l’autre, le dernier deux fois
area-hint = Touchez les angles, le dernier deux fois
angle-hint = Touchez trois points ; le deuxième est le sommet
profile-hint = Touchez les deux bouts d’une ligne
laid-lines-hint = Touchez deux coins d’une zone sans trous
stroke-hint = Touchez le papier des deux côtés du trait
probe-hint = Touchez un point
difference-hint = Touchez deux points d’une même feuille
reading-hint = Touchez la feuille pour lire ce qui s’y trouve

## Cartel

at-true-size = taille réelle
at-true-size-perhaps = taille réelle, si l’écran a 96 pixels par pouce
tier-draft = ébauche
tier-study = étude
no-hotspots = aucun détail sur cette face
hotspot-leads = Touchez encore : { $title }

## Légende

legend-layer = { $title } · { $share } %
legend-luminance = { $value } de la luminance du blanc
legend-band = réflectance à { $band }
legend-difference = réflectance à { $first } − { $second }
legend-bands = rouge { $red }, vert { $green }, bleu { $blue }
enhanced-relief = relief seul, sans couleur
enhanced-steepness = relief { $times } fois plus accentué
enhanced-contrast = contraste étiré : de { $low } à { $high } % du blanc
enhanced-sharpness = netteté : { $share } %

## Conseils

touch-to-turn = Un doigt tourne la feuille
touch-to-move = Un doigt déplace la feuille
pinch-to-zoom = Deux doigts la rapprochent
drag-lamp = Tenez la lampe et déplacez-la
two-visitors = L’un peut tenir la feuille, l’autre la lampe
attract-invitation = Touchez la feuille
countdown = { $seconds ->
        [one] Retour au début dans { $seconds } seconde
        [many] Retour au début dans { $seconds } secondes
       *[other] Retour au début dans { $seconds } secondes
    }
stay = Je suis encore là
closed = Fermé

## Personnel

staff-pin = Code du personnel
staff-wrong = Code erroné
staff-wait = { $seconds ->
        [one] Attendez { $seconds } seconde
        [many] Attendez { $seconds } secondes
       *[other] Attendez { $seconds } secondes
    }
staff-quit = Quitter Recto
staff-restart = Redémarrer
staff-next-exhibit = Exposition suivante
staff-chart = Mire de contrôle
staff-hours-off = Rester ouvert
staff-panel = Personnel

## Mesures

reading = { $quantity } : { $value }
reading-none = { $quantity } : aucun
reading-waiting = mesure en cours…
reading-nothing = rien à mesurer ici
reading-none-why = { $quantity } : aucun, { $why }
reading-failed = non mesuré : { $why }
why-off-sheet = un point est hors de la feuille
why-too-wide = c’est plus large que la feuille
why-no-picture = cette face n’a pas d’image
why-no-height = le relief de cette face n’a pas été relevé
why-unreadable = un fichier est illisible
why-gone = le dessin ou son état n’est plus là
why-one-place = deux points sont trop proches
why-crosses-itself = le contour se croise
why-no-area = les angles sont sur une même ligne
why-no-stroke = il n’y a pas de trait ici
why-several-strokes = il y a plus d’un trait ici
why-no-paper = il n’y a pas de papier nu aux deux bouts
why-oblique = le trait est oblique de { $degrees }° ; tournez la ligne
why-too-little = trop peu se trouve sur la feuille
why-coarse = l’image est trop grossière
why-small = la zone est trop petite
why-covered = il y a trop de dessin
why-faint = aucune ligne ne ressort
note-unregistered = on ne sait pas avec quelle précision { $file } est placé sur la feuille ; ce n’est pas compté
note-fitted = { $file } est ajusté, non mesuré : l’incertitude est celle de la lecture
note-assumed = { $file } est supposé, non mesuré : l’incertitude est celle de la lecture
note-no-picture = cette face n’a pas d’image : l’incertitude est celle du pointage seul
note-stroke = lu dans { $file } à mi-profondeur, sur { $length } du trait
note-lines = lu dans { $file } ; directions dans le sens horaire depuis l’horizontale
note-colours = couleurs de { $file } à la lumière du jour (D65), quelle que soit la lampe
under-place = { $across } mm depuis la gauche, { $down } mm depuis le haut
under-nothing = rien
under-false-colour = fausse couleur, rouge { $red }, vert { $green }, bleu { $blue }
under-reflectance = { $value } de réflectance
quantity-length = longueur
quantity-area = surface
quantity-perimeter = périmètre
quantity-angle = angle
quantity-width = largeur
quantity-height = hauteur
quantity-roughness = rugosité
quantity-trend = pente
quantity-laid-spacing = écart des vergeures
quantity-laid-direction = direction des vergeures
quantity-chain-spacing = écart des pontuseaux
quantity-chain-direction = direction des pontuseaux
quantity-difference = différence ΔE00

## Avis

saved = enregistré comme vue { $name }
not-saved = non enregistré : le terminal dit pourquoi
not-saved-changed = non enregistré : le manifeste a changé entre-temps
not-saved-read-only = non enregistré : le manifeste est en lecture seule
not-saved-unwritable = non enregistré : le manifeste ne peut être écrit
not-saved-at-fault = non enregistré : le manifeste contient des erreurs
link-printed = un lien est dans le terminal
exporting = export vers { $file }…
exported = exporté : { $file }
not-exported = non exporté : le terminal dit pourquoi

## Clavier et souris

keys-drag = glisser
keys-wheel = molette, + −
keys-double-click = double-clic
keys-arrows = flèches
keys-lamp = glisser (bouton droit), L + glisser, Maj + flèches
keyboard-shift = Maj
keyboard-control = Ctrl
keyboard-enter = Entrée
keyboard-backspace = Retour arrière
keyboard-space = Espace
key-turn = tourner la feuille ; la déplacer de près
key-zoom = plus près, plus loin
key-true-size = taille réelle et retour
key-move = déplacer de près
key-flip = retourner la feuille
key-lamp = déplacer la lampe
key-presets = lampe zénithale, à 45°, rasante
key-state = état suivant, précédent
key-overlays = calques : aucun, chacun, tous
key-opacity = calques plus pâles, plus forts
key-category = catégorie suivante seule, précédente
key-compare = comparaison suivante, précédente
key-share = déplacer le rideau, doser le fondu
key-angle = tourner le rideau, agrandir la loupe, ΔE00 ou lumière
key-through = moins, plus de lumière à travers la feuille
key-enhance = relief seul, accentué, contraste, plus net
key-scene = vue suivante, précédente
key-home = la vue telle qu’elle était
key-hotspots = détails : un clic pour ouvrir, deux pour y aller
key-next-hotspot = détail suivant, précédent, vers sa vue
key-next-control = commande suivante, précédente, l’actionner
key-controls = commandes
key-measure = outil de mesure suivant, précédent : un clic le pose
key-end-path = finir un tracé, annuler un point ou une mesure
key-under = ce qui est sous le pointeur
key-save = enregistrer la vue
key-link = afficher un lien vers la vue
key-export = exporter une figure, ou sa lumière en EXR
key-tier = niveau de précision suivant, précédent
key-caption = cartel
key-escape = plein écran, ranger, fermer ou quitter
