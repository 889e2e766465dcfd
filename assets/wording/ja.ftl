# Recto が来館者に示す言葉、日本語。

language-name = 日本語

## 操作

flip = 裏返す
lamp = ランプ
scenes = 見どころ
compare = 比べる
overlays = レイヤー
light-table = 透過光
measure = 測る
home = 最初へ
language = 言語
text-size = 文字サイズ
contrast = コントラスト
motion = 動き
help = 使い方
close = 閉じる
next = 次へ
previous = 前へ
back = 戻る
done = 完了
take-back = 取り消す
more = その他
enlarge = 文字を大きく
normal-size = 標準の文字
high-contrast = 高コントラスト
reduced-motion = 動きを減らす
zoom-in = 近づける
zoom-out = 遠ざける
true-size = 原寸大
hotspots = 細部
caption = 解説
legend = 凡例

## 紙

recto = 表
verso = 裏
before = 以前
after = 以後

## ランプ

zenithal = 真上から
oblique = 斜め45°
raking-left = 左から
raking-right = 右から
raking-top = 上辺から
raking-bottom = 下辺から
intensity = 明るさ
brighter = 明るく
dimmer = 暗く
warmer = 暖色へ
cooler = 寒色へ
lamp-elevation = 高さ{ $elevation }°
lamp-azimuth = 方位{ $azimuth }°
intensity-times = 明るさ × { $times }
light-table-share = 透過光 { $share }%
colour-temperature = { $kelvin } K
lamp-overhead = ランプは真上
lamp-place = ランプの高さ{ $elevation }°、{ $from ->
        [right] 右から
        [upper-right] 右上から
        [top] 上から
        [upper-left] 左上から
        [left] 左から
        [lower-left] 左下から
        [bottom] 下から
       *[lower-right] 右下から
    }（{ $azimuth }°）

## 比較とレイヤー

curtain = カーテン
side-by-side = 並べる
blend = 混ぜる
loupe = ルーペ
difference = 差
flicker = 交互
glass = 透かし見
opacity = 濃さ
opacity-share = 濃さ { $share }%
no-overlay = レイヤーなし
no-state = 紙そのもの
comparing-curtain = カーテン
comparing-side-by-side = 並べて比較
comparing-blend = 混合、二つ目が{ $share }%
comparing-loupe = ルーペ、{ $times }倍
comparing-difference = 差
comparing-flicker = 交互、{ $number }番
comparing-glass = 透かし見、反対の面が{ $share }%
light-through = 紙を通る光{ $share }%

## 計測

ruler = 定規
line = 道のり
area = 面積
angle = 角度
profile = 起伏
laid-lines = 簀の目
stroke = 線の太さ
probe = 色
reading-out = ここにあるもの
ruler-hint = 二か所に触れてください
line-hint = 順に触れ、最後は二度触れてください
area-hint = 角に順に触れ、最後は二度触れてください
angle-hint = 三か所に触れてください。二番目が角の頂点です
profile-hint = 線の両端に触れてください
laid-lines-hint = 穴のない範囲の二つの角に触れてください
stroke-hint = 線の両側の紙に触れてください
probe-hint = 一か所に触れてください
difference-hint = 同じ紙の二か所に触れてください
reading-hint = 紙に触れると、そこにあるものが読めます

## 解説

at-true-size = 原寸大
at-true-size-perhaps = 画面が1インチ96画素なら原寸大
tier-draft = 下描き
tier-study = 研究用
no-hotspots = この面に細部の解説はありません
hotspot-leads = もう一度触れる：{ $title }

## 凡例

legend-layer = { $title } · { $share }%
legend-luminance = 白の輝度の { $value }
legend-band = { $band } の反射率
legend-difference = { $first } − { $second } の反射率
legend-bands = 赤 { $red }、緑 { $green }、青 { $blue }
enhanced-relief = 起伏だけ、色なし
enhanced-steepness = 起伏を{ $times }倍に強調
enhanced-contrast = コントラスト拡大：白の{ $low }〜{ $high }%
enhanced-sharpness = 鮮明化：{ $share }%

## 案内

touch-to-turn = 一本の指で紙を傾けます
touch-to-move = 一本の指で紙を動かします
pinch-to-zoom = 二本の指で近づけます
drag-lamp = ランプを押さえて動かします
two-visitors = 一人が紙を、もう一人がランプを動かせます
attract-invitation = 紙に触れてください
countdown = あと{ $seconds }秒で最初に戻ります
stay = まだ見ています
closed = 閉館中

## 職員

staff-pin = 職員用の暗証番号
staff-wrong = 暗証番号が違います
staff-wait = { $seconds }秒お待ちください
staff-quit = Recto を終了
staff-restart = 再起動
staff-next-exhibit = 次の展示
staff-chart = テストチャート
staff-hours-off = このまま開ける
staff-panel = 職員用

## 測定値

reading = { $quantity }：{ $value }
reading-none = { $quantity }：なし
reading-waiting = 測定中…
reading-nothing = ここに測れるものはありません
reading-none-why = { $quantity }：なし（{ $why }）
reading-failed = 測定できません：{ $why }
why-off-sheet = 紙の外の場所があります
why-too-wide = 紙より幅が広すぎます
why-no-picture = この面には画像がありません
why-no-height = この面の起伏は記録されていません
why-unreadable = 読めないファイルがあります
why-gone = その素描または状態はもうありません
why-one-place = 二か所が近すぎます
why-crosses-itself = 輪郭が交差しています
why-no-area = 角が一直線上にあります
why-no-stroke = ここに線はありません
why-several-strokes = ここには線が二本以上あります
why-no-paper = 両端に何も描かれていない紙がありません
why-oblique = 線が{ $degrees }°斜めです。向きを変えてください
why-too-little = 紙の上にある部分が少なすぎます
why-coarse = 画像が粗すぎます
why-small = 範囲が小さすぎます
why-covered = 描かれた部分が多すぎます
why-faint = 目立つ線がありません
note-unregistered = { $file } が紙にどれほど正確に重なるかは不明で、不確かさに含まれていません
note-fitted = { $file } は推定値で、測定値ではありません。不確かさは読み取りのものです
note-assumed = { $file } は仮定値で、測定値ではありません。不確かさは読み取りのものです
note-no-picture = この面には画像がなく、不確かさは指し示す位置だけのものです
note-stroke = { $file } から半分の深さで、線の { $length } にわたって読み取り
note-lines = { $file } から読み取り。向きは水平から時計回り
note-colours = 点いている照明によらず、昼光（D65）での { $file } の色
under-place = 左から { $across } mm、上から { $down } mm
under-nothing = なし
under-false-colour = 疑似色、赤 { $red }、緑 { $green }、青 { $blue }
under-reflectance = 反射率 { $value }
quantity-length = 長さ
quantity-area = 面積
quantity-perimeter = 周の長さ
quantity-angle = 角度
quantity-width = 幅
quantity-height = 高さ
quantity-roughness = 粗さ
quantity-trend = 傾き
quantity-laid-spacing = 簀の目の間隔
quantity-laid-direction = 簀の目の向き
quantity-chain-spacing = 鎖線の間隔
quantity-chain-direction = 鎖線の向き
quantity-difference = 色差 ΔE00

## お知らせ

saved = 見どころ { $name } として保存しました
not-saved = 保存できませんでした。理由は端末にあります
not-saved-changed = 保存できませんでした。その間に設定ファイルが変わりました
not-saved-read-only = 保存できませんでした。設定ファイルは読み取り専用です
not-saved-unwritable = 保存できませんでした。設定ファイルに書き込めません
not-saved-at-fault = 保存できませんでした。設定ファイルに誤りがあります
link-printed = リンクを端末に表示しました
exporting = { $file } に書き出し中…
exported = 書き出しました：{ $file }
not-exported = 書き出せませんでした。理由は端末にあります

## キーボードとマウス

keys-drag = ドラッグ
keys-wheel = ホイール、+ −
keys-double-click = ダブルクリック
keys-arrows = 矢印キー
keys-lamp = 右ドラッグ、L + ドラッグ、Shift + 矢印
keyboard-shift = Shift
keyboard-control = Ctrl
keyboard-enter = Enter
keyboard-backspace = Backspace
keyboard-space = スペース
key-turn = 紙を傾ける。近づけたときは動かす
key-zoom = 近づける、遠ざける
key-true-size = 原寸大と元の大きさ
key-move = 近づけたときに動かす
key-flip = 紙を裏返す
key-lamp = ランプを動かす
key-presets = ランプを真上、45°、斜光に
key-state = 次の状態、前の状態
key-overlays = レイヤー：なし、一つずつ、すべて
key-opacity = レイヤーを薄く、濃く
key-category = 次の分類だけ、前の分類だけ
key-compare = 次の比較、前の比較
key-share = カーテンを動かす、混ぜ方を変える
key-angle = カーテンを回す、ルーペを大きく、ΔE00 か光
key-through = 紙を通る光を弱く、強く
key-enhance = 起伏だけ、起伏を強く、コントラスト、鮮明に
key-scene = 次の見どころ、前の見どころ
key-home = 見どころを元に戻す
key-hotspots = 細部：クリックで開き、もう一度で移動
key-next-hotspot = 次の細部、前の細部、その見どころへ
key-next-control = 次の操作、前の操作、実行
key-controls = 操作ボタン
key-measure = 次の計測道具、前の道具：クリックで置く
key-end-path = 道のりを終える、点や測定を取り消す
key-under = ポインターの下にあるもの
key-save = 見どころを保存
key-link = 見どころへのリンクを表示
key-export = 図を書き出す、または光を EXR で
key-tier = 次の精度、前の精度
key-caption = 解説
key-escape = 全画面、片付ける、閉じる、終了
